// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What has to be known of an inertial sensor before it can be integrated: which way is down, its
// biases, and its unit (docs/theory/inertial.md).
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
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

/// What leaves so many times less squared error is not better by chance. By a factor of two the
/// opposite sign fits better in one healthy start in nine, where a sensor hardly accelerates.
inline constexpr double kClearlyBetter = 8.0;

/// Can the sensor be used from here on?
inline bool is_started(ImuStartStatus status) {
  return status == ImuStartStatus::at_rest || status == ImuStartStatus::in_motion;
}

/// at_rest.
struct StartedAtRest {
  double duration = 0.0;  ///< s
  bool in_g = false;      ///< the accelerometer reports in g
};
/// in_motion.
struct StartedInMotion {
  std::size_t poses = 0;
  bool in_g = false;      ///< the accelerometer reports in g
  bool negative = false;  ///< it reports gravity instead of its reaction
  /// Where it is negative: the squared error that the usual sign leaves, over that of this one; 0
  /// where the usual sign makes no gravity like the Earth's.
  double usual_error = 0.0;
};
/// in_motion: readings are back after a gap; gravity and biases are those from before.
struct StartedAfterGap {};
/// too_short, at rest.
struct TooFewReadings {
  std::size_t readings = 0;
  double duration = 0.0;         ///< s
  std::size_t needed = 0;        ///< readings
  double needed_duration = 0.0;  ///< s
};
/// too_short, in motion.
struct TooFewPoses {
  std::size_t poses = 0;
  std::size_t needed = 0;  ///< over half a second
};
/// not_at_rest: standard deviations of the readings, and what they stay below at rest.
struct NotAtRest {
  double gyro = 0.0;         ///< rad/s
  double accel = 0.0;        ///< m/s²
  double gyro_limit = 0.0;   ///< rad/s
  double accel_limit = 0.0;  ///< m/s²
};
/// not_at_rest: the gyroscope's mean is too much for a bias.
struct SteadyTurn {
  double rate = 0.0;  ///< rad/s
};
/// implausible, at rest.
struct NoGravityAtRest {
  double reading = 0.0;  ///< the accelerometer's mean, in its own unit
  /// recording.accelerometer_scale that makes it gravity; none where it is too far off for an error
  /// of scale.
  std::optional<double> scale{};
};
/// implausible, in motion.
struct NoGravityInMotion {
  double gravity = 0.0;  ///< what poses and readings make of it, in the accelerometer's own unit
};
/// unobserved.
struct GravityUnclear {
  double sigma = 0.0;  ///< rad, of gravity's direction
};

/// Why a start ended as it did: what was seen, and what was expected.
using ImuStartReason = std::variant<TooFewReadings, TooFewPoses, NotAtRest, SteadyTurn,
                                    NoGravityAtRest, NoGravityInMotion, GravityUnclear,
                                    StartedAtRest, StartedInMotion, StartedAfterGap>;

/// How a start ended. Everything but `status` and `reason` holds only if is_started(status).
struct ImuStart {
  ImuStartStatus status = ImuStartStatus::too_short;
  ImuStartReason reason;
  double accel_scale = 1.0;  ///< readings times this are m/s²: 9.80665 for a sensor that reports in
                             ///< g, negative for one that reports gravity instead of its reaction
  /// Up in the body's axes at the end of the readings, unit.
  Eigen::Vector3d up_body = Eigen::Vector3d::UnitZ();
  double gravity_sigma = 0.0;  ///< rad, of that direction
  /// In motion only: the squared error that the accelerometer's other sign leaves, over that of
  /// this one. Infinite where the other makes no gravity like the Earth's; below 1: the other fits
  /// better, but not clearly.
  double other_sign_error = std::numeric_limits<double>::infinity();
  /// In motion only: gravity in the map, m/s², and the velocity at the last pose, m/s.
  Eigen::Vector3d gravity_map = Eigen::Vector3d(0.0, 0.0, -kStandardGravity);
  Eigen::Vector3d v_map_body = Eigen::Vector3d::Zero();
  double velocity_sigma = 0.0;  ///< m/s
  /// At rest only, m/s²: how well gravity and bias together explain the readings. Neither is known
  /// as well by itself: a tilt looks like a bias.
  std::optional<double> rest_sigma{};
  ImuBias bias;
  ImuBias bias_sigma;  ///< standard deviations, each axis
};

/// Does the motion tell the accelerometer's sign from the other? At rest, and in motion that is too
/// little, both explain the readings: of a sensor upside down.
inline bool is_sign_told(const ImuStart& start) {
  return start.status == ImuStartStatus::in_motion && start.other_sign_error >= kClearlyBetter;
}

/// From a sensor at rest: gravity's direction and the gyroscope's bias are the means. What gravity
/// is short of or beyond 9.81 m/s² is the accelerometer's bias along it; across it nothing is seen
/// of it, and it is taken as 0 with a wide sigma.
ImuStart start_at_rest(std::span<const ImuSample> samples, const ImuNoise& noise);

/// From a moving sensor: `T_map_body` at each stamp from another source, such as alignments, with
/// standard deviations of 2 cm and 5 mrad; `readings[i]` lie between poses i and i + 1. Gyroscope
/// bias from rotations, then velocities, gravity of 9.81 m/s² and the accelerometer's bias from
/// positions. The usual sign of the accelerometer unless the opposite one is clearly better.
/// `unheld[i]` are the directions, unit, map axes, in which nothing held the position of
/// pose i, which then tells nothing along them; empty: all was held.
ImuStart start_in_motion(std::span<const StampedPose> T_map_body,
                         std::span<const std::vector<ImuSample>> readings, const ImuNoise& noise,
                         std::span<const std::vector<Eigen::Vector3d>> unheld = {});

/// R_map_body of a body that sees up at `up_body`: z of the map is up, and the body's x has no
/// component along the map's y (its y none along the map's x where x is vertical).
Eigen::Matrix3d level_attitude(const Eigen::Vector3d& up_body);

/// Samples with their accelerations multiplied.
std::vector<ImuSample> with_accel_scale(std::span<const ImuSample> samples, double scale);

}  // namespace adit
