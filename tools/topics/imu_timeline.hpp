// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What an IMU read over time, and when it was at rest.
#pragma once

#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/topics/timeline.hpp"

namespace adit {

/// Sums of readings that are numbers.
struct ImuBin {
  double samples = 0.0;
  double turns = 0.0;  ///< number with angular velocities
  Eigen::Vector3d rotation_sum = Eigen::Vector3d::Zero();
  double rotation_squares = 0.0;
  Eigen::Vector3d acceleration_sum = Eigen::Vector3d::Zero();
  double acceleration_squares = 0.0;

  void add(const ImuBin& other);

  Eigen::Vector3d rotation() const;      ///< mean, rad/s; NaN without any
  Eigen::Vector3d acceleration() const;  ///< mean, in the sensor's unit; NaN without any
  double rotation_deviation() const;     ///< norm of the standard deviations of the axes
  double acceleration_deviation() const;
};
using ImuTimeline = Timeline<ImuBin>;

/// A reading; one without an angular velocity has NaN there.
ImuBin one_reading(const ImuSample& sample);

/// A second or more in which nothing moves, as far as readings tell: what drives evenly is as
/// quiet.
struct RestStretch {
  double begin = 0.0;                                      ///< s after the first reading
  double end = 0.0;                                        ///< s
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();     ///< rad/s: the mean
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< mean, in the sensor's unit
};

/// By the deviations that also start the odometry at rest, about the means of a whole stretch.
std::vector<RestStretch> rest_stretches(const ImuTimeline& timeline);

}  // namespace adit
