// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/view_server.hpp"

#include <array>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "adit/tools/support/usage_error.hpp"
#include "adit/tools/support/version.hpp"
#include "adit/tools/viewer/page_session.hpp"

namespace adit {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using Error = boost::system::error_code;

constexpr std::chrono::milliseconds kAsked{100};
constexpr std::string_view kCrowded =
    "HTTP/1.1 503 Service Unavailable\r\nConnection: close\r\nContent-Length: 0\r\n\r\n";

std::string_view view(beast::string_view text) {
  return {text.data(), text.size()};
}

http::status status_of(ViewRefusal refusal) {
  switch (refusal) {
    case ViewRefusal::too_large:
      return http::status::payload_too_large;
    case ViewRefusal::unknown_path:
      return http::status::not_found;
    case ViewRefusal::malformed:
      return http::status::bad_request;
    default:
      return http::status::forbidden;
  }
}

/// What all connections share.
struct Service {
  ViewSite site;
  ViewAccess access;
  ViewLimits limits;
  ViewCounts counts;
  std::size_t connections = 0;
  std::set<class Client*> clients;
  std::string run = make_token();  ///< a name of this one among all

  void refuse(ViewRefusal refusal) { ++counts.refusals[static_cast<std::size_t>(refusal)]; }
};

/// One of the connections that are counted.
class Counted {
 public:
  explicit Counted(Service& service) : service_(&service) { ++service.connections; }
  Counted(Counted&& other) noexcept : service_(std::exchange(other.service_, nullptr)) {}
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;
  Counted& operator=(Counted&&) = delete;
  ~Counted() {
    if (service_ != nullptr) {
      --service_->connections;
    }
  }

 private:
  Service* service_;
};

/// A client that is connected. It has one message on its way, however much it has asked for.
class Client : public std::enable_shared_from_this<Client> {
 public:
  Client(Service& service, Counted counted, beast::tcp_stream stream)
      : service_(service), counted_(std::move(counted)), socket_(std::move(stream)) {
    buffer_.max_size(service.limits.message_bytes + 64);
  }
  ~Client() { service_.clients.erase(this); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// `foxglove`: the name of its protocol that was chosen; empty: the client is a page.
  void begin(const http::request<http::empty_body>& request, std::string_view foxglove) {
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = service_.limits.request;
    timeout.idle_timeout = service_.limits.silence;
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.read_message_max(service_.limits.message_bytes);
    if (!foxglove.empty()) {
      is_page_ = false;
      socket_.set_option(
          websocket::stream_base::decorator([foxglove](websocket::response_type& response) {
            response.set(http::field::sec_websocket_protocol,
                         beast::string_view(foxglove.data(), foxglove.size()));
          }));
    }
    socket_.async_accept(request, [self = shared_from_this()](Error error) {
      if (error) {
        self->service_.refuse(ViewRefusal::malformed);
        return;
      }
      self->greet();
    });
  }

  /// Gets what there is for it, unless something is on its way.
  void pump() {
    if (sending_ || closing_) {
      return;
    }
    std::optional<ViewFrame> frame = session_->next();
    if (frame && frame->refused) {
      close(*frame->refused, websocket::close_code::policy_error);
    } else if (frame) {
      write(std::move(*frame));
    }
  }

 private:
  void greet() {
    if (is_page_) {
      session_ = std::make_unique<PageSession>(service_.site, service_.limits.waiting);
    } else {
      session_ = std::make_unique<FoxgloveSession>(service_.site.foxglove, service_.run);
    }
    ++service_.counts.clients;
    service_.clients.insert(this);
    pump();
    read();
  }

  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](Error error, std::size_t) {
      if (error) {
        self->end(error);
        return;
      }
      self->take();
    });
  }

  void take() {
    const std::string message = beast::buffers_to_string(buffer_.data());
    buffer_.consume(buffer_.size());
    const bool is_text = socket_.got_text();
    const ViewTaken taken = session_->take(message, is_text);
    if (!taken.goes_on) {
      close(*taken.refused,
            is_text ? websocket::close_code::policy_error : websocket::close_code::unknown_data);
      return;
    }
    if (taken.refused) {
      service_.refuse(*taken.refused);
    }
    pump();
    if (taken.to_all) {
      for (Client* client : service_.clients) {
        client->tell(taken.to_all);
      }
    }
    read();
  }

  void tell(const ViewText& text) {
    if (closing_) {
      return;
    }
    if (const auto refusal = session_->tell(text)) {
      close(*refusal, websocket::close_code::policy_error);
    } else {
      pump();
    }
  }

  void write(ViewFrame frame) {
    current_ = std::move(frame);
    socket_.binary(!current_.is_text);
    if (!current_.is_text) {
      ++(is_page_ ? service_.counts.tiles : service_.counts.messages);
    }
    const std::array<asio::const_buffer, 2> buffers = {
        asio::buffer(current_.head),
        current_.content ? asio::buffer(*current_.content) : asio::const_buffer()};
    sending_ = true;
    socket_.async_write(buffers, [self = shared_from_this()](Error error, std::size_t bytes) {
      self->sending_ = false;
      self->service_.counts.bytes_sent += bytes;
      if (!error) {
        self->pump();
      }
    });
  }

  void close(ViewRefusal refusal, websocket::close_code code) {
    service_.refuse(refusal);
    closing_ = true;
    if (!sending_) {
      socket_.async_close(code, [self = shared_from_this()](Error) {});
    } else {
      beast::get_lowest_layer(socket_).cancel();
    }
  }

  void end(Error error) {
    closing_ = true;
    if (error == websocket::error::message_too_big || error == websocket::error::buffer_overflow) {
      service_.refuse(ViewRefusal::too_large);
    } else if (error == beast::error::timeout) {
      service_.refuse(ViewRefusal::too_slow);
    } else if (error.category() ==
                   websocket::make_error_code(websocket::error::closed).category() &&
               error != websocket::error::closed) {
      service_.refuse(ViewRefusal::malformed);
    }
    beast::get_lowest_layer(socket_).cancel();
  }

  Service& service_;
  Counted counted_;
  websocket::stream<beast::tcp_stream> socket_;
  beast::flat_buffer buffer_;
  std::unique_ptr<ViewSession> session_;  ///< from the greeting on
  ViewFrame current_;                     ///< on its way
  bool is_page_ = true;
  bool sending_ = false;
  bool closing_ = false;
};

/// A connection until it has got its page or has become a Client.
class Visitor : public std::enable_shared_from_this<Visitor> {
 public:
  Visitor(Service& service, tcp::socket socket)
      : service_(service), counted_(service), stream_(std::move(socket)) {
    parser_.header_limit(static_cast<uint32_t>(service.limits.header_bytes));
    parser_.body_limit(uint64_t{0});
    buffer_.max_size(service.limits.header_bytes + 1024);
  }

  void begin() {
    stream_.expires_after(service_.limits.request);
    http::async_read(stream_, buffer_, parser_,
                     [self = shared_from_this()](Error error, std::size_t) { self->take(error); });
  }

 private:
  void take(Error error) {
    if (error == http::error::end_of_stream ||
        (error == beast::error::timeout && !parser_.got_some())) {
      return;  // it said nothing: browsers open connections in advance
    }
    if (error) {
      const bool large = error == http::error::header_limit || error == http::error::body_limit ||
                         error == http::error::buffer_overflow ||
                         error == http::error::unexpected_body;
      const bool slow = error == beast::error::timeout;
      const ViewRefusal refusal = large  ? ViewRefusal::too_large
                                  : slow ? ViewRefusal::too_slow
                                         : ViewRefusal::malformed;
      refuse(refusal);
      return;
    }
    const auto& request = parser_.get();
    const std::string_view target = view(request.target());
    const bool upgrades = websocket::is_upgrade(request);
    const std::string_view foxglove =
        upgrades && service_.site.foxglove && path_of(target) == "/"
            ? foxglove_protocol_of(view(request[http::field::sec_websocket_protocol]))
            : std::string_view();
    const auto refusal = refusal_of(service_.access, {.host = view(request[http::field::host]),
                                                      .origin = view(request[http::field::origin]),
                                                      .target = target,
                                                      .is_foxglove = !foxglove.empty()});
    if (refusal) {
      refuse(*refusal);
    } else if (!foxglove.empty() || (upgrades && path_of(target) == "/socket")) {
      stream_.expires_never();
      std::make_shared<Client>(service_, std::move(counted_), std::move(stream_))
          ->begin(request, foxglove);
    } else if (request.method() != http::verb::get && request.method() != http::verb::head) {
      refuse(ViewRefusal::malformed);
    } else if (path_of(target) != "/") {
      refuse(ViewRefusal::unknown_path);
    } else {
      send_page(request.method() == http::verb::head);
    }
  }

  void refuse(ViewRefusal refusal) {
    service_.refuse(refusal);
    response_.result(status_of(refusal));
    response_.set(http::field::content_type, "text/plain; charset=utf-8");
    response_.body() = "refused: " + std::string(to_string(refusal)) + "\n";
    if (refusal == ViewRefusal::wrong_token) {
      response_.body() += "Open the link that the program has printed.\n";
    }
    send();
  }

  void send_page(bool head) {
    response_.result(http::status::ok);
    response_.set(http::field::content_type, "text/html; charset=utf-8");
    response_.set(http::field::content_encoding, "gzip");
    response_.set(http::field::cache_control, "no-store");
    if (!head) {
      response_.body() = std::string(service_.site.page);
    }
    send();
  }

  void send() {
    response_.version(11);
    response_.keep_alive(false);
    response_.set(http::field::server, std::string(kGenerator));
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("X-Frame-Options", "DENY");
    response_.prepare_payload();
    stream_.expires_after(service_.limits.request);
    http::async_write(stream_, response_, [self = shared_from_this()](Error error, std::size_t) {
      if (error == beast::error::timeout) {
        self->service_.refuse(ViewRefusal::too_slow);
      }
      Error none;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, none);
    });
  }

  Service& service_;
  Counted counted_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  http::request_parser<http::empty_body> parser_;
  http::response<http::string_body> response_;
};

tcp::endpoint endpoint_of(const std::string& address, uint16_t port) {
  Error error;
  const asio::ip::address numeric = asio::ip::make_address(address, error);
  if (error) {
    throw UsageError("--listen: '" + address +
                     "' is not a numeric address. Use localhost, an address of this machine, or "
                     "0.0.0.0 for all of them.");
  }
  return {numeric, port};
}

std::string link_of(const ViewAccess& access, const std::string& scheme, uint16_t port,
                    const std::string& token) {
  const bool v6 = access.address.find(':') != std::string::npos;
  return scheme + "://" + (v6 ? "[" + access.address + "]" : access.address) + ":" +
         std::to_string(port) + "/" + (token.empty() ? "" : "?token=" + token);
}

}  // namespace

uint64_t ViewCounts::refused() const {
  return std::accumulate(refusals.begin(), refusals.end(), uint64_t{0});
}

class ViewServer::Listener {
 public:
  Listener(ViewSite site, const ViewAccess& access, uint16_t port, const ViewLimits& limits)
      : acceptor_(io_), timer_(io_) {
    service_.site = std::move(site);
    service_.access = access;
    service_.limits = limits;
    const tcp::endpoint endpoint = endpoint_of(access.address, port);
    try {
      acceptor_.open(endpoint.protocol());
      acceptor_.set_option(asio::socket_base::reuse_address(true));
      acceptor_.bind(endpoint);
      acceptor_.listen();
    } catch (const boost::system::system_error& error) {
      throw UsageError("port " + std::to_string(port) + " of " + access.address +
                       " cannot be listened on: " + error.code().message() +
                       (error.code() == boost::system::errc::address_not_available
                            ? ". --listen takes an address of this machine."
                            : ". --port 0 takes any that is free."));
    }
  }

  uint16_t port() const { return acceptor_.local_endpoint().port(); }
  const ViewAccess& access() const { return service_.access; }

  ViewCounts run(const std::function<bool()>& stop) {
    accept();
    ask(stop);
    io_.run();
    return service_.counts;
  }

 private:
  void accept() {
    acceptor_.async_accept([this](Error error, tcp::socket socket) {
      if (!error && service_.connections >= service_.limits.clients) {
        service_.refuse(ViewRefusal::too_many);
        Error none;
        socket.non_blocking(true, none);
        socket.send(asio::buffer(kCrowded), 0, none);
        socket.shutdown(tcp::socket::shutdown_both, none);
      } else if (!error) {
        Error none;
        socket.set_option(tcp::no_delay(true), none);
        std::make_shared<Visitor>(service_, std::move(socket))->begin();
      }
      accept();
    });
  }

  void ask(const std::function<bool()>& stop) {
    if (stop()) {
      io_.stop();
      return;
    }
    for (Client* client : service_.clients) {
      client->pump();
    }
    timer_.expires_after(kAsked);
    timer_.async_wait([this, &stop](Error) { ask(stop); });
  }

  Service service_;  // before io_, whose handlers hold connections
  asio::io_context io_{1};
  tcp::acceptor acceptor_;
  asio::steady_timer timer_;
};

ViewServer::ViewServer(ViewSite site, const ViewAccess& access, uint16_t port,
                       const ViewLimits& limits)
    : listener_(std::make_unique<Listener>(std::move(site), access, port, limits)) {}

ViewServer::~ViewServer() = default;

uint16_t ViewServer::port() const {
  return listener_->port();
}

std::string ViewServer::link() const {
  return link_of(listener_->access(), "http", port(), listener_->access().token);
}

std::string ViewServer::foxglove_link() const {
  return link_of(listener_->access(), "ws", port(), listener_->access().foxglove_token);
}

ViewCounts ViewServer::run(const std::function<bool()>& stop) {
  return listener_->run(stop);
}

}  // namespace adit
