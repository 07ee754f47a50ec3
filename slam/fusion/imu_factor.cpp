// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/imu_factor.hpp"

#include <Eigen/Cholesky>

namespace adit {
namespace {

// Rows.
constexpr int kPosition = 0;
constexpr int kRotation = 3;
constexpr int kVelocity = 6;

// A single step makes position and velocity one measurement; this keeps its covariance regular.
constexpr double kFloorPosition = 1e-5;  // m
constexpr double kFloorRotation = 1e-7;  // rad
constexpr double kFloorVelocity = 1e-5;  // m/s

Matrix9d floored(const Matrix9d& covariance) {
  Vector9d floor;
  floor << Eigen::Vector3d::Constant(kFloorPosition), Eigen::Vector3d::Constant(kFloorRotation),
      Eigen::Vector3d::Constant(kFloorVelocity);
  return covariance + Matrix9d(floor.cwiseAbs2().asDiagonal());
}

}  // namespace

LinkFactor<9> imu_factor(const Preintegration& preintegration, const NavState& from,
                         const NavState& to) {
  const double t = preintegration.duration;
  const Eigen::Vector3d& gravity = from.gravity_map;
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d R_body_map = from.T_map_body.linear().transpose();
  const Eigen::Matrix3d R_from_to = R_body_map * to.T_map_body.linear();
  const MotionIncrement measured = corrected(preintegration, from.bias);
  const Eigen::Vector3d position =
      R_body_map * (to.T_map_body.translation() - from.T_map_body.translation() -
                    t * from.v_map_body - 0.5 * t * t * gravity);
  const Eigen::Vector3d velocity = R_body_map * (to.v_map_body - from.v_map_body - t * gravity);
  const Eigen::Vector3d rotation = so3_log(measured.rotation.transpose() * R_from_to);
  const Eigen::Matrix3d turn = so3_right_jacobian_inverse(rotation);
  const Eigen::Vector3d bias_turn =
      preintegration.rotation_by_gyro * (from.bias.gyro - preintegration.bias.gyro);

  LinkFactor<9> factor;
  factor.residual << position - measured.position, rotation, velocity - measured.velocity;

  factor.by_from.block<3, 3>(kPosition, kPositionAt) = -identity;
  factor.by_from.block<3, 3>(kPosition, kRotationAt) = skew(position);
  factor.by_from.block<3, 3>(kPosition, kVelocityAt) = -t * R_body_map;
  factor.by_from.block<3, 3>(kPosition, kGyroBiasAt) = -preintegration.position_by_gyro;
  factor.by_from.block<3, 3>(kPosition, kAccelBiasAt) = -preintegration.position_by_accel;
  factor.by_from.block<3, 3>(kRotation, kRotationAt) = -turn * R_from_to.transpose();
  factor.by_from.block<3, 3>(kRotation, kGyroBiasAt) =
      -turn * so3_exp(-rotation) * so3_right_jacobian(bias_turn) * preintegration.rotation_by_gyro;
  factor.by_from.block<3, 3>(kVelocity, kRotationAt) = skew(velocity);
  factor.by_from.block<3, 3>(kVelocity, kVelocityAt) = -R_body_map;
  factor.by_from.block<3, 3>(kVelocity, kGyroBiasAt) = -preintegration.velocity_by_gyro;
  factor.by_from.block<3, 3>(kVelocity, kAccelBiasAt) = -preintegration.velocity_by_accel;

  const Eigen::Matrix<double, 3, 2> gravity_turn = R_body_map * skew(gravity) * across(gravity);
  factor.by_from.block<3, 2>(kPosition, kGravityAt) = 0.5 * t * t * gravity_turn;
  factor.by_from.block<3, 2>(kVelocity, kGravityAt) = t * gravity_turn;

  factor.by_to.block<3, 3>(kPosition, kPositionAt) = R_from_to;
  factor.by_to.block<3, 3>(kRotation, kRotationAt) = turn;
  factor.by_to.block<3, 3>(kVelocity, kVelocityAt) = R_body_map;

  const Eigen::LLT<Matrix9d> whitening(floored(whole_covariance(preintegration)));
  whitening.matrixL().solveInPlace(factor.residual);
  whitening.matrixL().solveInPlace(factor.by_from);
  whitening.matrixL().solveInPlace(factor.by_to);
  return factor;
}

}  // namespace adit
