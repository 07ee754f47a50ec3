// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "adit/tools/live/live_recording.hpp"
#include "adit/tools/publishing/duration_sample.hpp"
#include "adit/tools/report/run_summary.hpp"

namespace adit {

/// From the arrival of a sweep's last point to its pose.
class LiveLatency {
 public:
  /// `arrivals` outlives it.
  explicit LiveLatency(ArrivalTimes& arrivals) : arrivals_(&arrivals) {}

  /// The sweep has its pose now. Returns its latency, ms; nothing where its arrival is not known.
  std::optional<double> add(Nanoseconds stamp);
  LiveReport report() const;

 private:
  ArrivalTimes* arrivals_;
  DurationSample sample_;
};

/// A line.
void say_latency(const LiveReport& report, std::ostream& err);

}  // namespace adit
