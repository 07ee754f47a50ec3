// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/live/live_latency.hpp"

#include <chrono>
#include <ostream>

#include <fmt/core.h>

namespace adit {

std::optional<double> LiveLatency::add(Nanoseconds stamp) {
  const auto arrival = arrivals_->take(stamp);
  if (!arrival) {
    return std::nullopt;
  }
  const std::chrono::duration<double, std::milli> latency =
      std::chrono::system_clock::now() - *arrival;
  sample_.add(latency.count());
  return latency.count();
}

LiveReport LiveLatency::report() const {
  return {.latency_p50_ms = sample_.quantile_ms(0.5),
          .latency_p99_ms = sample_.quantile_ms(0.99),
          .sweeps = sample_.count()};
}

void say_latency(const LiveReport& report, std::ostream& err) {
  err << fmt::format("latency: median {:.0f} ms, 99 % {:.0f} ms, of {} sweeps\n",
                     report.latency_p50_ms, report.latency_p99_ms, report.sweeps);
  if (report.high_rate_poses > 0) {
    err << fmt::format("age of the high-rate poses: median {:.1f} ms, 99 % {:.1f} ms, of {}\n",
                       report.high_rate_age_p50_ms, report.high_rate_age_p99_ms,
                       report.high_rate_poses);
  }
}

}  // namespace adit
