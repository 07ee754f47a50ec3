// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Preintegration on the manifold after C. Forster et al., "On-Manifold Preintegration for Real-Time
// Visual-Inertial Odometry", T-RO 2017, with mid-point samples (docs/theory/inertial.md).
#pragma once

#include <span>

#include "adit/slam/core/imu_noise.hpp"
#include "adit/slam/core/nav_state.hpp"

namespace adit {

/// Motion between two times as the body's inertial sensor felt it: relative to the pose, velocity
/// and gravity at its begin, in the body's axes there.
struct MotionIncrement {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< R_begin_end
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      ///< m/s, without gravity
  Eigen::Vector3d position = Eigen::Vector3d::Zero();      ///< m, without gravity and v t
};

/// An increment with its covariance and what it owes to the biases it was integrated with.
struct Preintegration {
  double duration = 0.0;  ///< s
  MotionIncrement increment;
  ImuBias bias;  ///< subtracted from each reading
  /// Ordered [position, rotation, velocity]: m², rad², (m/s)²; right perturbation of the rotation.
  Matrix9d covariance = Matrix9d::Zero();
  double scale = 0.0;  ///< ImuNoise::scale, which the covariance leaves out: whole_covariance()
  Eigen::Matrix3d rotation_by_gyro = Eigen::Matrix3d::Zero();   ///< d rotation / d b_g, s
  Eigen::Matrix3d velocity_by_gyro = Eigen::Matrix3d::Zero();   ///< d velocity / d b_g, m/rad
  Eigen::Matrix3d velocity_by_accel = Eigen::Matrix3d::Zero();  ///< d velocity / d b_a, s
  Eigen::Matrix3d position_by_gyro = Eigen::Matrix3d::Zero();   ///< d position / d b_g, m s/rad
  Eigen::Matrix3d position_by_accel = Eigen::Matrix3d::Zero();  ///< d position / d b_a, s²
};

/// s. Where neighbouring readings are farther apart some are missing.
constexpr double kReadingGap = 0.05;

/// One more step of length `to.stamp - from.stamp`: the increment grows by what was read at its
/// ends. Across a gap what the missing ones might have been is in the covariance.
Preintegration advanced(const Preintegration& so_far, const ImuSample& from, const ImuSample& to,
                        const ImuNoise& noise);

/// Integrates readings in order of time, from the first's stamp to the last's. Fewer than two give
/// a duration of 0.
Preintegration preintegrate(std::span<const ImuSample> samples, const ImuBias& bias,
                            const ImuNoise& noise);

/// The covariance with what errors of scale do to the whole increment. They are the same from
/// reading to reading, so no sum of white noise grows as they do.
Matrix9d whole_covariance(const Preintegration& preintegration);

/// The increment with other biases, to first order.
MotionIncrement corrected(const Preintegration& preintegration, const ImuBias& bias);

/// The biases are so far from those integrated with that the first order is not enough: 2 mrad or
/// 0.2 m/s².
bool is_stale(const Preintegration& preintegration, const ImuBias& bias);

/// The state at the end of the increment.
NavState predict(const NavState& state, const Preintegration& preintegration);

}  // namespace adit
