// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/udp_receiver.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <exception>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "adit/tools/packets/hesai_packets.hpp"
#include "adit/tools/packets/livox_packets.hpp"
#include "adit/tools/packets/ouster_packets.hpp"
#include "adit/tools/packets/velodyne_packets.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/stop_signal.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

constexpr int kWantedBuffer = 32 << 20;  // bytes
constexpr int kPollMs = 20;
constexpr int kMostInARow = 512;  // datagrams, before they are written and other sockets are read

std::string text_of_address(uint32_t address) {
  const in_addr raw{.s_addr = htonl(address)};
  std::array<char, INET_ADDRSTRLEN> text{};
  return inet_ntop(AF_INET, &raw, text.data(), text.size()) != nullptr ? text.data() : "";
}

/// What the kernel reports with a datagram.
struct Ancillary {
  Nanoseconds received{0};
  std::optional<uint32_t> lost{};  ///< datagrams so far
};

Ancillary ancillary_of(msghdr& message) {
  Ancillary found;
  for (cmsghdr* one = CMSG_FIRSTHDR(&message); one != nullptr; one = CMSG_NXTHDR(&message, one)) {
    if (one->cmsg_level != SOL_SOCKET) {
      continue;
    }
    if (one->cmsg_type == SCM_TIMESTAMPNS) {
      timespec time{};
      std::memcpy(&time, CMSG_DATA(one), sizeof(time));
      found.received = std::chrono::seconds(time.tv_sec) + Nanoseconds(time.tv_nsec);
    } else if (one->cmsg_type == SO_RXQ_OVFL) {
      uint32_t lost = 0;
      std::memcpy(&lost, CMSG_DATA(one), sizeof(lost));
      found.lost = lost;
    }
  }
  return found;
}

}  // namespace

std::optional<UdpEndpoint> udp_endpoint(const std::string& source) {
  constexpr std::string_view kScheme = "udp://";
  if (!source.starts_with(kScheme)) {
    return std::nullopt;
  }
  const std::string rest = source.substr(kScheme.size());
  const std::size_t colon = rest.rfind(':');
  UdpEndpoint endpoint{.address = rest.substr(0, colon)};
  const std::string port = colon == std::string::npos ? "" : rest.substr(colon + 1);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), endpoint.port);
  in_addr address{};
  if (error != std::errc{} || end != port.data() + port.size() || endpoint.port == 0 ||
      inet_pton(AF_INET, endpoint.address.c_str(), &address) != 1) {
    throw UsageError(source +
                     ": must be udp://ADDRESS:PORT with an IPv4 address of this machine, "
                     "for example udp://127.0.0.1:2368.");
  }
  return endpoint;
}

std::string text_of(const UdpEndpoint& endpoint) {
  return "udp://" + endpoint.address + ":" + std::to_string(endpoint.port);
}

UdpReceiver::UdpReceiver(const std::vector<UdpEndpoint>& endpoints, PacketSink& sink,
                         std::optional<OusterSensor> ouster)
    : sink_(sink), ouster_(std::move(ouster)), buffer_(1U << 16U) {
  try {
    for (const UdpEndpoint& endpoint : endpoints) {
      open(endpoint);
    }
  } catch (...) {
    for (const Socket& socket : sockets_) {
      ::close(socket.descriptor);
    }
    throw;
  }
  thread_ = std::jthread([this](const std::stop_token& stop) { receive(stop); });
}

UdpReceiver::~UdpReceiver() {
  thread_.request_stop();
  if (thread_.joinable()) {
    thread_.join();
  }
  for (const Socket& socket : sockets_) {
    ::close(socket.descriptor);
  }
}

void UdpReceiver::open(const UdpEndpoint& endpoint) {
  Socket socket{.endpoint = endpoint};
  socket.descriptor = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int on = 1;
  const int descriptor = socket.descriptor;
  ::setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &kWantedBuffer, sizeof(kWantedBuffer));
  ::setsockopt(descriptor, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof(on));
  ::setsockopt(descriptor, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof(on));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(endpoint.port);
  inet_pton(AF_INET, endpoint.address.c_str(), &address.sin_addr);
  socket.address = ntohl(address.sin_addr.s_addr);
  if (descriptor < 0 ||
      ::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    const std::string reason = std::strerror(errno);
    if (descriptor >= 0) {
      ::close(descriptor);
    }
    throw InputError(text_of(endpoint), {}, "adit cannot listen there: " + reason,
                     "Name an address of this machine and a port that no other program uses");
  }
  int granted = 0;
  socklen_t size = sizeof(granted);
  ::getsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &granted, &size);
  socket.counts.buffer = static_cast<uint64_t>(granted) / 2;  // Linux reports it doubled
  sockets_.push_back(std::move(socket));
}

void UdpReceiver::receive(const std::stop_token& stop) {
  std::vector<pollfd> waiting;
  for (const Socket& socket : sockets_) {
    waiting.push_back({.fd = socket.descriptor, .events = POLLIN, .revents = 0});
  }
  try {
    bool more = true;
    while (more) {
      more = !stop.stop_requested() && StopSignal::received() == 0;
      ::poll(waiting.data(), waiting.size(), more ? kPollMs : 0);
      for (Socket& socket : sockets_) {
        drain(socket);
      }
      sink_.commit();
    }
  } catch (const std::exception& error) {
    const std::scoped_lock lock(mutex_);
    failure_ = error.what();
  }
  sink_.finish();
}

void UdpReceiver::drain(Socket& socket) {
  for (int i = 0; i < kMostInARow; ++i) {
    sockaddr_in from{};
    iovec part{.iov_base = buffer_.data(), .iov_len = buffer_.size()};
    alignas(cmsghdr) std::array<char, 256> control{};
    msghdr message{};
    message.msg_name = &from;
    message.msg_namelen = sizeof(from);
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t size = ::recvmsg(socket.descriptor, &message, 0);
    if (size < 0) {
      return;
    }
    const Ancillary ancillary = ancillary_of(message);
    if (ancillary.lost) {
      const std::scoped_lock lock(mutex_);
      socket.counts.lost = *ancillary.lost;
    }
    take(socket, {.received = ancillary.received,
                  .sender = ntohl(from.sin_addr.s_addr),
                  .receiver = socket.address,
                  .sender_port = ntohs(from.sin_port),
                  .receiver_port = socket.endpoint.port,
                  .payload = std::span(buffer_).first(static_cast<std::size_t>(size))});
  }
}

void UdpReceiver::take(Socket& socket, const ReceivedDatagram& datagram) {
  const bool known = is_known(datagram);
  const std::scoped_lock lock(mutex_);
  if (!known) {
    ++socket.counts.unknown;
    return;
  }
  if (!socket.first_sender) {
    socket.first_sender = datagram.sender;
    socket.counts.sender = text_of_address(datagram.sender);
  }
  if (datagram.sender != *socket.first_sender) {
    ++socket.counts.other_senders;
    return;
  }
  ++socket.counts.datagrams;
  socket.counts.bytes += datagram.payload.size();
  sink_.add(datagram);
}

bool UdpReceiver::is_known(const ReceivedDatagram& received) const {
  const Datagram datagram{.received = received.received,
                          .source = received.sender,
                          .port = received.receiver_port,
                          .payload = received.payload};
  if (ouster_) {
    return is_ouster_data(datagram, *ouster_) || is_ouster_imu(datagram);
  }
  return is_velodyne_data(datagram) || is_velodyne_position(datagram) ||
         hesai_packet(datagram).has_value() || is_livox_data(datagram) || is_livox_imu(datagram);
}

std::vector<UdpCounts> UdpReceiver::counts() const {
  const std::scoped_lock lock(mutex_);
  std::vector<UdpCounts> counts;
  for (const Socket& socket : sockets_) {
    counts.push_back(socket.counts);
  }
  return counts;
}

std::string UdpReceiver::failure() const {
  const std::scoped_lock lock(mutex_);
  return failure_;
}

}  // namespace adit
