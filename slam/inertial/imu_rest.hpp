// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What an inertial sensor reads while nothing moves.
#pragma once

#include <span>

#include "adit/slam/core/types.hpp"

namespace adit {

inline constexpr double kRestGyroBias = 0.2;  ///< rad/s, of the mean; more than that is a rotation

/// The norm of the standard deviations of the three axes, with motors running; somebody who walks
/// makes ten times as much.
inline constexpr double kRestGyro = 0.02;  ///< rad/s
inline constexpr double kRestAccel = 0.3;  ///< m/s²

/// Means, and the norms of the three axes' standard deviations.
struct ReadingStatistics {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< rad/s
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< in the readings' own unit
  double gyro_deviation = 0.0;
  double accel_deviation = 0.0;
};
ReadingStatistics statistics_of(std::span<const ImuSample> samples);

/// Readings that could be those of a sensor at rest, or of one that goes on as it went; m/s².
bool is_quiet(const ReadingStatistics& readings);

}  // namespace adit
