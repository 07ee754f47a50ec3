// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How far GNSS fixes are off: how much of what receivers say of themselves is believed.
#pragma once

#include <span>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/slam/core/types.hpp"

namespace adit {

/// Chi squared of three directions, 99 %: a fix that lies farther from where the map has it, with
/// kShapeNoise allowed for, is an outlier.
inline constexpr double kFixGate = 11.34;
/// Standard deviation of the map's own shape, m.
inline constexpr double kShapeNoise = 0.1;
/// The same between places near each other, m.
inline constexpr double kMapNoise = 0.05;
/// Standard deviation of an altitude that was not measured, m: all of the Earth's surface is
/// within.
inline constexpr double kUnknownHeight = 1e4;

/// The covariance (east north up, m^2) that a fix counts with: the receiver's times the configured
/// scale, but no standard deviation below that of a good receiver with such a fix, since many state
/// a tenth of their errors: ground-augmented (RTK) 0.02 m, satellite-augmented 0.3 m, single 1.5 m,
/// upwards twice that. What the receiver does not state is three times those. The altitude of a fix
/// without one has a standard deviation of kUnknownHeight.
Eigen::Matrix3d fix_covariance(const GnssFix& fix, const GnssConfig& config);

/// Of a fix without an altitude (or none that is known): the same with kUnknownHeight upwards.
Eigen::Matrix3d without_height(Eigen::Matrix3d covariance);
/// Whether a fix with such a covariance has an altitude.
inline bool has_height(const Eigen::Matrix3d& covariance) {
  return covariance(2, 2) < kUnknownHeight * kUnknownHeight;
}

/// What a fix with such a covariance tells (1/m^2); nothing about its height, where that does not
/// count.
Eigen::Matrix3d fix_information(const Eigen::Matrix3d& covariance, bool height);

/// How many independent fixes each of these counts as. A receiver's errors stay much the same for
/// about `correlation` (s): a stretch of T seconds, however many fixes it has, knows its mean as
/// well as 1 + T / (2 correlation) independent ones do (first-order Gauss-Markov), which its fixes
/// share by the time that each stands for. Times in s, increasing.
std::vector<double> independent_shares(std::span<const double> times, double correlation);

}  // namespace adit
