// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "adit/slam/fusion/high_rate.hpp"
#include "adit/slam/fusion/inertial_tracker.hpp"
#include "adit/slam/inertial/imu_buffer.hpp"

namespace adit {

/// The lidar at the time of one inertial reading.
struct LidarMotion {
  Nanoseconds stamp{0};
  Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();
  Eigen::Vector3d v_map_lidar = Eigen::Vector3d::Zero();       ///< m/s, map axes
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< rad/s, lidar axes
  /// Covariance of [rho, phi, v]: the pose's part in lidar axes, the velocity's in the map's. The
  /// reading's own white noise is not in the velocity's.
  Matrix9d covariance = Matrix9d::Zero();
};

/// What the state of the body says of the lidar on it.
LidarMotion lidar_motion(const HighRateState& state, const Eigen::Isometry3d& T_body_lidar);

/// Odometry at the rate of the inertial sensor, beside an Odometry: takes the readings that it took
/// and the reports that it gave. Each pose is what was known when its reading came: the newest
/// fused sweep, carried on, by the clock and the mounting that the reports have refined. Stamps
/// only rise.
///
/// There are none while the sensor is not fused, behind a gap in the readings (imu.max_gap) until
/// the next fused sweep, and beyond a second after the last one.
class HighRateStream {
 public:
  /// `smoothing` in s: corrections are spread over this time; 0: they show as steps.
  HighRateStream(const ImuConfig& config, double smoothing);

  /// The next reading, in the sensor's own unit and clock, and what became of it.
  std::optional<LidarMotion> add(const ImuSample& reading, ImuArrival arrival);

  /// The report of the next sweep.
  void update(const InertialReport& report);

 private:
  void stop();

  double max_gap_;  ///< s
  HighRateOdometry odometry_;
  Eigen::Isometry3d T_body_lidar_ = Eigen::Isometry3d::Identity();
  double accel_scale_ = 1.0;
  Nanoseconds clock_offset_{0};          ///< taken off the stamps of readings
  std::optional<Nanoseconds> estimate_;  ///< stamp of the newest
  std::optional<Nanoseconds> newest_;    ///< reading
  Nanoseconds whole_since_{0};           ///< no gap since this reading
  std::optional<Nanoseconds> given_;     ///< stamp of the last motion
};

}  // namespace adit
