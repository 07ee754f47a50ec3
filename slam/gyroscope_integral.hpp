// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "slam/types.hpp"

namespace adit {

/// The integral of a gyroscope's rates over time. Over the tenths of a second between sweeps it is
/// the rotation vector, to the second order of the angle. Times are in s after `origin`; samples
/// that are repeated or out of order are left out.
class GyroscopeIntegral {
 public:
  GyroscopeIntegral(std::span<const ImuSample> samples, Nanoseconds origin);

  /// Whether there are samples from begin to end, without a gap of more than 0.1 s.
  bool covers(double begin, double end) const;

  /// From the first sample to a time that is covered, rad.
  Eigen::Vector3d at(double time) const;

  /// At a time that is covered, rad/s.
  Eigen::Vector3d rate(double time) const;

 private:
  /// The last sample that has one behind it and is not after the time.
  std::size_t before(double time) const;

  std::vector<double> times_;
  std::vector<Eigen::Vector3d> rates_;
  std::vector<Eigen::Vector3d> integrals_;
  std::vector<std::pair<double, double>> gaps_;
};

}  // namespace adit
