// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "adit/slam/core/types.hpp"

namespace adit {

/// The integral of a gyroscope's rates over time, and the integral of that. Over the tenths of a
/// second between sweeps the first is the rotation vector, to the second order of the angle; the
/// second, divided by a time, its mean over it. Rates are linear between samples. Times are s from
/// `origin`, in the gyroscope's clock.
class GyroscopeIntegral {
 public:
  /// Samples that repeat a stamp or go back are left out.
  GyroscopeIntegral(std::span<const ImuSample> samples, Nanoseconds origin);

  /// There are samples from `begin` to `end`, without a gap.
  bool covers(double begin, double end) const;

  /// rad/s; for these three the time must be covered.
  Eigen::Vector3d rate(double time) const;
  /// rad, from the first sample on; its mean over `span` s from `time` on, where that is not 0.
  Eigen::Vector3d angle(double time, double span = 0.0) const;
  /// rad/s: how the angle changes with the time.
  Eigen::Vector3d angle_rate(double time, double span = 0.0) const;

 private:
  /// The last sample that has one behind it and is not after the time.
  std::size_t before(double time) const;
  /// The integral of angle(), rad s.
  Eigen::Vector3d sum(double time) const;

  std::vector<double> times_;
  std::vector<Eigen::Vector3d> rates_;
  std::vector<Eigen::Vector3d> angles_;
  std::vector<Eigen::Vector3d> sums_;
  std::vector<std::pair<double, double>> gaps_;
};

}  // namespace adit
