// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/live_latency.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ostream>

#include <fmt/core.h>

namespace adit {

void LiveLatency::add(Nanoseconds stamp) {
  using Milliseconds = std::chrono::duration<float, std::milli>;
  if (const auto arrival = arrivals_->take(stamp)) {
    ms_.push_back(Milliseconds(std::chrono::system_clock::now() - *arrival).count());
  }
}

LiveReport LiveLatency::report() const {
  LiveReport report{.sweeps = ms_.size()};
  if (ms_.empty()) {
    return report;
  }
  std::vector<float> sorted = ms_;
  std::ranges::sort(sorted);
  const auto at = [&](double share) {
    const auto rank =
        static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
    return static_cast<double>(sorted[std::max<std::size_t>(rank, 1) - 1]);
  };
  report.latency_p50_ms = at(0.5);
  report.latency_p99_ms = at(0.99);
  return report;
}

void say_latency(const LiveReport& report, std::ostream& err) {
  err << fmt::format("latency: median {:.0f} ms, 99 % {:.0f} ms, of {} sweeps\n",
                     report.latency_p50_ms, report.latency_p99_ms, report.sweeps);
}

}  // namespace adit
