// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/gpsd_receiver.hpp"

#include <array>
#include <chrono>
#include <exception>
#include <string_view>
#include <utility>

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "adit/tools/live/gpsd_report.hpp"
#include "adit/tools/live/live_timer.hpp"
#include "adit/tools/live/topic_choice.hpp"
#include "adit/tools/recordings/ros_visit.hpp"
#include "adit/tools/support/stop_signal.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

constexpr const char* kGpsdPort = "2947";
constexpr std::string_view kWatch = "?WATCH={\"enable\":true,\"json\":true};\n";
constexpr auto kConnectEvery = std::chrono::seconds(1);
constexpr int kPollMs = 50;
constexpr std::size_t kLongestLine = 65536;  // bytes; gpsd's are at most 10240

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
  GpsdEndpoint endpoint{.host = rest.substr(0, colon),
                        .port = colon == std::string::npos ? kGpsdPort : rest.substr(colon + 1)};
  if (endpoint.host.empty() || endpoint.port.empty()) {
    throw UsageError(source + ": must be gpsd://HOST or gpsd://HOST:PORT.");
  }
  return endpoint;
}

std::optional<GpsdEndpoint> gpsd_among(const std::vector<std::string>& sources) {
  for (const std::string& source : sources) {
    if (auto endpoint = gpsd_endpoint(source)) {
      return endpoint;
    }
  }
  return std::nullopt;
}

Channel gpsd_channel() {
  return channel_of({.name = "/gpsd/fix", .type = std::string(ros::NavSatFix::kType)});
}

GpsdReceiver::GpsdReceiver(GpsdEndpoint endpoint, MessageSink& sink, std::size_t channel)
    : endpoint_(std::move(endpoint)), sink_(sink), channel_(channel) {
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
  if (::send(descriptor, kWatch.data(), kWatch.size(), MSG_NOSIGNAL) < 0) {
    return;
  }
  GpsdReports reports;
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
      const Nanoseconds received = now();
      if (const auto fix = reports.take(line, received)) {
        sink_.write(channel_, received, ros::encode(Encoding::cdr, *fix));
        ++fixes_;
      }
      line.clear();
    }
  }
}

}  // namespace adit
