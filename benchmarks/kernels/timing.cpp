// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/kernels/timing.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

namespace adit::bench {

Spread spread_of(std::vector<double> values) {
  if (values.empty()) {
    throw std::invalid_argument("no run to take the spread of");
  }
  std::ranges::sort(values);
  const auto at = [&](double part) {
    return values[static_cast<size_t>(std::lround(part * static_cast<double>(values.size() - 1)))];
  };
  return {at(0.1), at(0.5), at(0.9)};
}

Sample time_on_host(const std::function<void()>& run) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  run();
  return {.device_ms = {},
          .wait_ms = {},
          .host_ms = std::chrono::duration<double, std::milli>(Clock::now() - begin).count()};
}

Timing measure(const Work& work, const Effort& effort) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> device;
  std::vector<double> wait;
  std::vector<double> host;
  const auto run = [&] {
    const Sample sample = work.run();
    if (work.undo) {
      work.undo();
    }
    return sample;
  };
  run();
  const Clock::time_point begin = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  int runs = 0;
  while (runs < effort.least_runs || (elapsed() < effort.seconds && runs < effort.most_runs)) {
    const Sample sample = run();
    if (sample.device_ms) {
      device.push_back(*sample.device_ms);
    }
    if (sample.wait_ms) {
      wait.push_back(*sample.wait_ms);
    }
    host.push_back(sample.host_ms);
    runs += 1;
  }
  const auto optional = [](const std::vector<double>& values) {
    return values.empty() ? std::nullopt : std::optional(spread_of(values));
  };
  return {
      .runs = runs, .device = optional(device), .wait = optional(wait), .host = spread_of(host)};
}

}  // namespace adit::bench
