// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/publishing/status_server.hpp"

#include <chrono>
#include <cstddef>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>

#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using Tcp = asio::ip::tcp;

constexpr auto kLongest = std::chrono::seconds(5);  // for a request and its answer
constexpr std::size_t kMostClients = 16;
constexpr uint32_t kMostHeader = 8192;  // bytes

/// A request and its answer.
class Exchange : public std::enable_shared_from_this<Exchange> {
 public:
  Exchange(Tcp::socket socket, const StatusServer::Answer& answer, std::size_t& clients)
      : stream_(std::move(socket)), answer_(answer), clients_(clients) {
    ++clients_;
    parser_.header_limit(kMostHeader);
    parser_.body_limit(0);
  }
  ~Exchange() { --clients_; }
  Exchange(const Exchange&) = delete;
  Exchange& operator=(const Exchange&) = delete;

  void begin() {
    stream_.expires_after(kLongest);
    http::async_read(stream_, buffer_, parser_,
                     [self = shared_from_this()](const beast::error_code& error, std::size_t) {
                       if (!error) {
                         self->reply();
                       }
                     });
  }

 private:
  void reply() {
    const auto& request = parser_.get();
    StatusAnswer answer{.code = 405, .type = "text/plain", .body = "GET alone is answered.\n"};
    const bool gets = request.method() == http::verb::get || request.method() == http::verb::head;
    if (gets) {
      const std::string target(request.target());
      answer = answer_(target.substr(0, target.find('?')));
    }
    response_.result(answer.code);
    response_.set(http::field::content_type, answer.type);
    response_.set(http::field::cache_control, "no-store");
    response_.keep_alive(false);
    response_.content_length(answer.body.size());
    if (request.method() != http::verb::head) {
      response_.body() = std::move(answer.body);
    }
    http::async_write(stream_, response_,
                      [self = shared_from_this()](const beast::error_code&, std::size_t) {
                        beast::error_code ignored;
                        self->stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
                      });
  }

  beast::tcp_stream stream_;
  const StatusServer::Answer& answer_;
  std::size_t& clients_;
  beast::flat_buffer buffer_;
  http::request_parser<http::string_body> parser_;
  http::response<http::string_body> response_;
};

}  // namespace

class StatusServer::Listener {
 public:
  Listener(uint16_t port, Answer answer) : acceptor_(context_), answer_(std::move(answer)) {
    try {
      const Tcp::endpoint endpoint(asio::ip::address_v4::loopback(), port);
      acceptor_.open(endpoint.protocol());
      acceptor_.set_option(asio::socket_base::reuse_address(true));
      acceptor_.bind(endpoint);
      acceptor_.listen();
    } catch (const boost::system::system_error& error) {
      throw UsageError("--status-port " + std::to_string(port) +
                       ": adit cannot listen there: " + error.code().message() + ".");
    }
    accept();
  }

  uint16_t port() const { return acceptor_.local_endpoint().port(); }
  void run() { context_.run(); }
  void stop() { context_.stop(); }

 private:
  void accept() {
    acceptor_.async_accept([this](const beast::error_code& error, Tcp::socket socket) {
      if (!error && clients_ < kMostClients) {
        std::make_shared<Exchange>(std::move(socket), answer_, clients_)->begin();
      }
      accept();
    });
  }

  std::size_t clients_ = 0;  ///< above what counts in it
  asio::io_context context_;
  Tcp::acceptor acceptor_;
  Answer answer_;
};

StatusServer::StatusServer(uint16_t port, Answer answer)
    : listener_(std::make_unique<Listener>(port, std::move(answer))),
      thread_([this] { listener_->run(); }) {}

StatusServer::~StatusServer() {
  listener_->stop();
  thread_.join();
}

uint16_t StatusServer::port() const {
  return listener_->port();
}

}  // namespace adit
