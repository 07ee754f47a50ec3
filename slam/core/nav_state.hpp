// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adit/slam/core/direction.hpp"
#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/types.hpp"
#include "adit/slam/core/units.hpp"

namespace adit {

/// Of a pose with a velocity.
using Vector9d = Eigen::Matrix<double, 9, 1>;
/// As above.
using Matrix9d = Eigen::Matrix<double, 9, 9>;

/// What an inertial sensor reads when it should read nothing; body axes.
struct ImuBias {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< rad/s
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< m/s²
};

/// What the scale and the mounting of a sensor of velocities lack: where it reads v, in its own
/// axes, the velocity is (1 + scale) (v + (0, turn) x v).
struct VelocityCalibration {
  double scale = 0.0;                              ///< share that it reads too little
  Eigen::Vector2d turn = Eigen::Vector2d::Zero();  ///< rad, about its y and z axes
};

/// The inertial state at a time. The body frame is that of the IMU.
///
/// Tangent vectors are ordered [rho, phi, v, b_g, b_a, gravity, velocity calibration]: the pose's
/// as everywhere (right perturbation), then velocity in the map's axes, then the biases, then the
/// direction of gravity in the map (two components, slam/core/direction.hpp), then scale and turn
/// of the sensor of velocities; m, rad, m/s, rad/s, m/s², rad, 1, rad.
struct NavState {
  Nanoseconds stamp{0};  ///< of the state
  Eigen::Isometry3d T_map_body =
      Eigen::Isometry3d::Identity();                     ///< maps body coordinates to the map
  Eigen::Vector3d v_map_body = Eigen::Vector3d::Zero();  ///< velocity of the body in the map, m/s
  ImuBias bias;                                          ///< of the IMU
  Eigen::Vector3d gravity_map = Eigen::Vector3d(0.0, 0.0, -kStandardGravity);  ///< m/s²
  VelocityCalibration velocity;  ///< of the sensor of velocities; zeros where there is none
};

/// Places of the parts in a tangent vector of NavState.
constexpr int kPositionAt = 0;
constexpr int kRotationAt = 3;    ///< see kPositionAt
constexpr int kVelocityAt = 6;    ///< see kPositionAt
constexpr int kGyroBiasAt = 9;    ///< see kPositionAt
constexpr int kAccelBiasAt = 12;  ///< see kPositionAt
constexpr int kGravityAt = 15;    ///< see kPositionAt
constexpr int kScaleAt = 17;      ///< see kPositionAt
constexpr int kTurnAt = 18;       ///< see kPositionAt
constexpr int kStateSize = 20;    ///< length of a tangent vector

/// A tangent vector of NavState.
using StateVector = Eigen::Matrix<double, kStateSize, 1>;
/// A covariance of NavState, or an information.
using StateMatrix = Eigen::Matrix<double, kStateSize, kStateSize>;

/// The state moved by a tangent vector; the stamp stays.
NavState retract(const NavState& state, const StateVector& delta);

/// The tangent vector at `from` that leads to `to`: the inverse of retract().
StateVector difference(const NavState& from, const NavState& to);

}  // namespace adit
