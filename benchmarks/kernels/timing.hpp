// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "adit/benchmarks/kernels/work.hpp"

namespace adit::bench {

/// Spread of several runs, ms: the 10th, 50th and 90th percentile.
struct Spread {
  double low = 0.0;
  double median = 0.0;
  double high = 0.0;
};

/// Throws std::invalid_argument where there are no values.
Spread spread_of(std::vector<double> values);

struct Timing {
  int runs = 0;
  std::optional<Spread> device;
  std::optional<Spread> wait;
  Spread host;

  /// The device's clock where there is one, else the host's.
  const Spread& best() const { return device ? *device : host; }
};

/// One run of something that the device has no part in.
Sample time_on_host(const std::function<void()>& run);

/// How long to measure each case.
struct Effort {
  double seconds = 0.5;
  int least_runs = 5;
  int most_runs = 500;
};

/// Runs the work once unseen (drivers compile at the first dispatch), then as often as the effort
/// says.
Timing measure(const Work& work, const Effort& effort);

}  // namespace adit::bench
