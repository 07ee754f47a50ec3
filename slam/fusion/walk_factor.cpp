// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/walk_factor.hpp"

#include <cmath>

namespace adit {
namespace {

// Scale and mounting of a sensor of velocities hardly change: load and warm tyres make 0.2 % and
// 2 mrad in 100 s. 1/√s and rad/√s.
constexpr double kCalibrationWalk = 2e-4;

/// How a unit vector changes as its direction is turned.
Eigen::Matrix<double, 3, 2> by_turn(const Eigen::Vector3d& unit) {
  return -skew(unit) * across(unit);
}

}  // namespace

LinkFactor<12> walk_factor(const ImuNoise& noise, double gravity_sigma, double duration,
                           const NavState& from, const NavState& to) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(noise.gyro_walk), Eigen::Vector3d::Constant(noise.accel_walk);
  const Vector6d weight = (std::sqrt(duration) * sigma).cwiseInverse();
  const double gravity_weight = 1.0 / gravity_sigma;
  const Eigen::Vector3d down_from = from.gravity_map.normalized();
  const Eigen::Vector3d down_to = to.gravity_map.normalized();
  Vector6d change;
  change << to.bias.gyro - from.bias.gyro, to.bias.accel - from.bias.accel;
  LinkFactor<12> factor;
  const double calibration_weight = 1.0 / (kCalibrationWalk * std::sqrt(duration));
  Eigen::Vector3d calibration;
  calibration << to.velocity.scale - from.velocity.scale, to.velocity.turn - from.velocity.turn;
  factor.residual << weight.cwiseProduct(change), gravity_weight * (down_to - down_from),
      calibration_weight * calibration;
  factor.by_to.block<6, 6>(0, kGyroBiasAt) = weight.asDiagonal();
  factor.by_from.block<6, 6>(0, kGyroBiasAt) = -factor.by_to.block<6, 6>(0, kGyroBiasAt);
  factor.by_to.block<3, 2>(6, kGravityAt) = gravity_weight * by_turn(down_to);
  factor.by_from.block<3, 2>(6, kGravityAt) = -gravity_weight * by_turn(down_from);
  factor.by_to.block<3, 3>(9, kScaleAt).diagonal().setConstant(calibration_weight);
  factor.by_from.block<3, 3>(9, kScaleAt) = -factor.by_to.block<3, 3>(9, kScaleAt);
  return factor;
}

}  // namespace adit
