// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What an inertial sensor has to be told before it can be integrated: which way is down, its
// biases, and its unit (docs/theory/inertial.md).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adit/slam/core/imu_noise.hpp"
#include "adit/slam/core/nav_state.hpp"

namespace adit {

enum class ImuStartStatus {
  at_rest,      ///< started from readings at rest
  in_motion,    ///< started from poses and the readings between them
  too_short,    ///< not enough readings or poses yet
  not_at_rest,  ///< the readings vary too much for a sensor at rest
  implausible,  ///< no unit makes the readings those of a sensor on Earth
  unobserved,   ///< the motion does not tell gravity from acceleration yet
};
std::string_view to_string(ImuStartStatus status);

/// Can the sensor be used from here on?
inline bool is_started(ImuStartStatus status) {
  return status == ImuStartStatus::at_rest || status == ImuStartStatus::in_motion;
}

/// How a start ended. Everything but `status` and `reason` holds only if is_started(status).
struct ImuStart {
  ImuStartStatus status = ImuStartStatus::too_short;
  std::string reason;        ///< for people: what was seen, and what was expected
  double accel_scale = 1.0;  ///< readings times this are m/s²: 9.80665 for a sensor that reports in
                             ///< g, negative for one that reports gravity instead of its reaction
  /// Up in the body's axes at the end of the readings, unit.
  Eigen::Vector3d up_body = Eigen::Vector3d::UnitZ();
  double gravity_sigma = 0.0;  ///< rad, of that direction
  /// In motion only: gravity in the map, m/s², and the velocity at the last pose, m/s.
  Eigen::Vector3d gravity_map = Eigen::Vector3d(0.0, 0.0, -kStandardGravity);
  Eigen::Vector3d v_map_body = Eigen::Vector3d::Zero();
  double velocity_sigma = 0.0;  ///< m/s
  ImuBias bias;
  ImuBias bias_sigma;  ///< standard deviations, each axis
};

/// From a sensor at rest: gravity's direction and the gyroscope's bias are the means. What gravity
/// is short of or beyond 9.81 m/s² is the accelerometer's bias along it; across it nothing is seen
/// of it, and it is taken as 0 with a wide sigma.
ImuStart start_at_rest(std::span<const ImuSample> samples, const ImuNoise& noise);

/// From a moving sensor: `T_map_body` at each stamp from another source, such as alignments, with
/// standard deviations of 2 cm and 5 mrad; `readings[i]` lie between poses i and i + 1. Gyroscope
/// bias from rotations, then velocities, gravity of 9.81 m/s² and the accelerometer's bias from
/// positions.
ImuStart start_in_motion(std::span<const StampedPose> T_map_body,
                         std::span<const std::vector<ImuSample>> readings, const ImuNoise& noise);

/// R_map_body of a body that sees up at `up_body`: z of the map is up, and the body's x has no
/// component along the map's y (its y none along the map's x where x is vertical).
Eigen::Matrix3d level_attitude(const Eigen::Vector3d& up_body);

/// Samples with their accelerations multiplied.
std::vector<ImuSample> with_accel_scale(std::span<const ImuSample> samples, double scale);

}  // namespace adit
