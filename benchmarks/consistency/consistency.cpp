// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/benchmarks/consistency/consistency.hpp"

#include <algorithm>
#include <cmath>

namespace adit::bench {
namespace {

constexpr Nanoseconds kEarlier = std::chrono::milliseconds(10);  // that a sweep may be

JudgedPose judged(const ConsistencySweep& sweep) {
  return {.estimate = {sweep.result.stamp, sweep.result.T_map_lidar, sweep.result.uncertainty},
          .T_world_lidar = sweep.T_world_lidar};
}

bool is_bridged(const ConsistencySweep& sweep) {
  return sweep.result.state == OdometryState::coasting ||
         sweep.result.state == OdometryState::restarted;
}

/// Sums over the innovations of a run: of products k sweeps apart (0: of squares), and how many.
struct Products {
  std::array<double, 6> sums{};
  double nis = 0.0;
  std::size_t degrees = 0;
  std::size_t count = 0;
};

void add(Products& products, const std::vector<ConsistencySweep>& run) {
  for (std::size_t i = 0; i < run.size(); ++i) {
    const Innovation& innovation = run[i].result.inertial.innovation;
    if (innovation.degrees == 0) {
      continue;
    }
    products.nis += innovation.nis;
    products.degrees += static_cast<std::size_t>(innovation.degrees);
    ++products.count;
    for (std::size_t k = 0; k < products.sums.size() && k <= i; ++k) {
      products.sums[k] += innovation.whitened.dot(run[i - k].result.inertial.innovation.whitened);
    }
  }
}

void add(Consistency& found, const std::vector<ConsistencySweep>& run) {
  const JudgedPose first = judged(run.front());
  std::array<std::size_t, kHorizons.size()> before{};  // the newest sweep that long before
  for (std::size_t i = 1; i < run.size(); ++i) {
    found.bridged += is_bridged(run[i]) ? 1U : 0U;
    found.path +=
        (run[i].T_world_lidar.translation() - run[i - 1].T_world_lidar.translation()).norm();
    const bool fused = run[i].result.inertial.nav.has_value();
    if (fused) {
      ++found.sweeps;
      found.all.add(motion_error(first, judged(run[i])));
    }
    for (std::size_t k = 0; k < kHorizons.size(); ++k) {
      const Nanoseconds latest = run[i].result.stamp - kHorizons[k] + kEarlier;
      while (before[k] + 1 < i && run[before[k] + 1].result.stamp <= latest) {
        ++before[k];
      }
      if (fused && run[before[k]].result.stamp <= latest) {
        found.motions[k].add(motion_error(judged(run[before[k]]), judged(run[i])));
      }
    }
  }
  const MotionError last = motion_error(first, judged(run.back()));
  found.last.add(last);
  found.error += last.error.head<3>().squaredNorm();
  found.turn += last.error.tail<3>().squaredNorm();
}

}  // namespace

Consistency consistency_of(std::span<const std::vector<ConsistencySweep>> runs) {
  Consistency found;
  Products products;
  for (const std::vector<ConsistencySweep>& run : runs) {
    if (run.size() > 1) {
      ++found.runs;
      add(found, run);
      add(products, run);
    }
  }
  const double n = static_cast<double>(std::max<std::size_t>(found.runs, 1));
  found.error = std::sqrt(found.error / n);
  found.turn = std::sqrt(found.turn / n);
  found.path /= n;
  found.nis = products.nis / static_cast<double>(std::max<std::size_t>(products.degrees, 1));
  for (std::size_t k = 0; k < found.correlation.size(); ++k) {
    found.correlation[k] = products.sums[0] > 0.0 ? products.sums[k + 1] / products.sums[0] : 0.0;
  }
  found.innovations = products.count;
  return found;
}

MeanBounds chi_squared_bounds(std::size_t samples, int degrees) {
  const double n = static_cast<double>(samples) * degrees;
  const double variance = 2.0 / (9.0 * n);
  const auto quantile = [&](double deviations) {
    return std::pow(1.0 - variance + deviations * std::sqrt(variance), 3.0);
  };
  return {.low = quantile(-1.96), .high = quantile(1.96)};
}

double white_bound(const Consistency& found) {
  return 1.96 / std::sqrt(6.0 * static_cast<double>(std::max<std::size_t>(found.innovations, 1)));
}

}  // namespace adit::bench
