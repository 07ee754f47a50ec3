// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/gpsd_receiver.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <exception>
#include <span>
#include <utility>

#include <fmt/core.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "adit/tools/live/live_timer.hpp"
#include "adit/tools/live/topic_choice.hpp"
#include "adit/tools/recordings/ros_visit.hpp"
#include "adit/tools/support/stop_signal.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

constexpr auto kConnectEvery = std::chrono::seconds(1);
constexpr int kPollMs = 50;
constexpr std::size_t kLongestLine = 16384;  // bytes; gpsd's are at most 10240

/// A descriptor, or -1.
int connect_to(const GpsdEndpoint& endpoint) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(endpoint.host.c_str(), endpoint.port.c_str(), &wanted, &found) != 0) {
    return -1;
  }
  int descriptor = -1;
  for (const addrinfo* one = found; one != nullptr && descriptor < 0; one = one->ai_next) {
    descriptor = ::socket(one->ai_family, one->ai_socktype | SOCK_CLOEXEC, one->ai_protocol);
    if (descriptor >= 0 && ::connect(descriptor, one->ai_addr, one->ai_addrlen) != 0) {
      ::close(descriptor);
      descriptor = -1;
    }
  }
  ::freeaddrinfo(found);
  return descriptor;
}

Nanoseconds now() {
  return std::chrono::duration_cast<Nanoseconds>(
      std::chrono::system_clock::now().time_since_epoch());
}

ros::NavSatFix message_of(const GnssFix& fix) {
  ros::NavSatFix message;
  message.header.stamp = fix.stamp;
  message.header.frame = "gnss";
  message.status = fix.kind == GnssFixKind::ground_augmented ? 2 : 0;
  message.latitude = fix.latitude;
  message.longitude = fix.longitude;
  message.altitude = fix.altitude;
  if (fix.covariance) {
    std::ranges::copy(fix.covariance->reshaped(), message.position_covariance.begin());
    message.position_covariance_type = 2;  // its diagonal is known
  }
  return message;
}

ReceivedDatagram datagram_of(std::string_view line, Nanoseconds received) {
  constexpr uint32_t kThisMachine = 0x7f000001;  // 127.0.0.1
  return {.received = received,
          .sender = kThisMachine,
          .receiver = kThisMachine,
          .sender_port = kGpsdPort,
          .receiver_port = kGpsdPort,
          .payload = std::as_bytes(std::span(line))};
}

bool goes_on(const std::stop_token& stop) {
  return !stop.stop_requested() && StopSignal::received() == 0;
}

}  // namespace

std::optional<GpsdEndpoint> gpsd_endpoint(const std::string& source) {
  constexpr std::string_view kScheme = "gpsd://";
  if (!source.starts_with(kScheme)) {
    return std::nullopt;
  }
  const std::string rest = source.substr(kScheme.size());
  const std::size_t colon = rest.rfind(':');
  GpsdEndpoint endpoint{
      .host = rest.substr(0, colon),
      .port = colon == std::string::npos ? std::to_string(kGpsdPort) : rest.substr(colon + 1)};
  if (endpoint.host.empty() || endpoint.port.empty()) {
    throw UsageError(source + ": must be gpsd://HOST or gpsd://HOST:PORT.");
  }
  return endpoint;
}

std::optional<GpsdEndpoint> gpsd_among(const std::vector<std::string>& sources) {
  std::optional<GpsdEndpoint> found;
  for (const std::string& source : sources) {
    if (auto endpoint = gpsd_endpoint(source)) {
      if (found) {
        throw UsageError(source + ": is a second gpsd. Name one.");
      }
      found = std::move(endpoint);
    }
  }
  return found;
}

Channel gpsd_channel() {
  return channel_of({.name = "/gpsd/fix", .type = std::string(ros::NavSatFix::kType)});
}

GpsdSink fixes_to_messages(MessageSink& sink, std::size_t channel) {
  return [&sink, channel, reports = GpsdReports()](std::string_view line,
                                                   Nanoseconds received) mutable {
    const std::optional<GnssFix> fix = reports.take(line, received);
    if (fix) {
      sink.write(channel, received, ros::encode(Encoding::cdr, message_of(*fix)));
    }
    return fix.has_value();
  };
}

void begin_gpsd(PacketSink& sink) {
  sink.add(datagram_of(kGpsdRequest, now()));
}

GpsdSink fixes_to_packets(PacketSink& sink) {
  return [&sink, reports = GpsdReports()](std::string_view line, Nanoseconds received) mutable {
    if (is_gpsd_report(line)) {
      sink.add(datagram_of(line, received));
    }
    return reports.take(line, received).has_value();
  };
}

std::string GpsdReceiver::text() const {
  return fmt::format("gpsd://{}:{}: {}, {} fixes", endpoint_.host, endpoint_.port,
                     connected_ ? "connected" : "not connected", fixes_.load());
}

GpsdReceiver::GpsdReceiver(GpsdEndpoint endpoint, GpsdSink sink)
    : endpoint_(std::move(endpoint)), sink_(std::move(sink)) {
  thread_ = std::jthread([this](const std::stop_token& stop) { receive(stop); });
}

GpsdReceiver::~GpsdReceiver() {
  thread_.request_stop();
  thread_.join();
}

void GpsdReceiver::receive(const std::stop_token& stop) {
  try {
    while (goes_on(stop)) {
      const int descriptor = connect_to(endpoint_);
      connected_ = descriptor >= 0;
      if (descriptor >= 0) {
        read_from(descriptor, stop);
        ::close(descriptor);
        connected_ = false;
      }
      const auto tried = LiveClock::now();
      while (goes_on(stop) && LiveClock::now() - tried < kConnectEvery) {
        std::this_thread::sleep_for(kLookEvery);
      }
    }
  } catch (const std::exception&) {
    connected_ = false;  // the file cannot be written: the receiver of the topics says so
  }
}

void GpsdReceiver::read_from(int descriptor, const std::stop_token& stop) {
  if (::send(descriptor, kGpsdRequest.data(), kGpsdRequest.size(), MSG_NOSIGNAL) < 0) {
    return;
  }
  std::string line;
  std::array<char, 4096> buffer{};
  while (goes_on(stop)) {
    pollfd waiting{.fd = descriptor, .events = POLLIN, .revents = 0};
    if (::poll(&waiting, 1, kPollMs) <= 0) {
      continue;
    }
    const ssize_t size = ::recv(descriptor, buffer.data(), buffer.size(), 0);
    if (size <= 0) {
      return;
    }
    for (const char one : std::string_view(buffer.data(), static_cast<std::size_t>(size))) {
      if (one != '\n') {
        line.push_back(one);
        if (line.size() > kLongestLine) {
          return;  // no gpsd
        }
        continue;
      }
      bytes_ += line.size();
      fixes_ += sink_(line, now()) ? 1U : 0U;
      line.clear();
    }
  }
}

}  // namespace adit
