// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/nav_state.hpp"
#include "adit/slam/fusion/inertial_event.hpp"
#include "adit/slam/fusion/sliding_graph.hpp"
#include "adit/slam/fusion/velocity_watch.hpp"

namespace adit {

/// What the inertial sensor does for the odometry.
enum class InertialState {
  absent,    ///< no readings came, or it is not to be used
  starting,  ///< gravity, biases and velocity are not known yet: the lidar goes alone
  fused,
  lost,     ///< a check failed: the lidar goes alone until the sensor has been started again
  refused,  ///< it was lost again and again: it stays out
};
std::string_view to_string(InertialState state);

/// What a sweep reports of the inertial sensor.
struct InertialReport {
  InertialState state = InertialState::absent;
  std::optional<InertialEvent> event;          ///< that came with this sweep
  std::optional<InertialHindrance> hindrance;  ///< what keeps the sensor from being started
  std::optional<NavState> nav;                 ///< the body's state, where this sweep was fused
  /// Covariance of nav, ordered as its tangent vectors: what the sliding graph leaves on its newest
  /// state. Finite and positive.
  StateMatrix nav_covariance = StateMatrix::Zero();
  /// Covariance of T_map_lidar in the submap, lidar axes, [rho, phi]: from nav and the alignment,
  /// whose errors are partly those of the sweeps before; zero where there is neither.
  Matrix6d lidar_covariance = Matrix6d::Zero();
  Eigen::Vector3d gravity_map = Eigen::Vector3d::Zero();  ///< m/s²; zero before a start
  Innovation innovation;         ///< the alignment's innovation; 0 degrees where there was none
  double innovation_gate = 0.0;  ///< bound of its nis: beyond it the alignment is an outlier
  std::vector<VelocityReport>
      velocities;                        ///< of sensors that measured the way since the last sweep
  std::optional<MotionShares> shares{};  ///< of the motion since the last sweep, where it was fused
  double bridged_gap = 0.0;              ///< s, the longest time without readings that was bridged
  bool compared = false;       ///< prediction and constant velocity, against the alignment:
  bool better_turn = false;    ///< the inertial prediction's rotation was nearer
  bool better_travel = false;  ///< its translation was
  double accel_scale = 1.0;    ///< from the accelerometer's own unit and sign to m/s²
  Eigen::Isometry3d T_body_lidar = Eigen::Isometry3d::Identity();  ///< refined, if it is to be
  double clock_offset = 0.0;  ///< s, taken off the stamps of readings; 0 unless it is refined
  /// The gyroscope against the sweeps, as they come: the latest that the motion constrained.
  std::optional<RotationComparison> comparison;
};

/// Does the sensor start with this sweep, from readings at rest since that time or before?
bool starts_at_rest_since(Nanoseconds begin, const InertialReport& report);

/// Standard deviation of gravity's direction in the map, rad, the greater of two; infinite where
/// the sweep was not fused.
double gravity_sigma(const InertialReport& report);

}  // namespace adit
