// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/velocity_factor.hpp"

#include <Eigen/Cholesky>

#include "adit/slam/fusion/pose_factor.hpp"

namespace adit {

LinkFactor<3> velocity_factor(const MeasuredDisplacement& measured, const NavState& from,
                              const NavState& to) {
  const Eigen::Matrix3d R_body_map = from.T_map_body.linear().transpose();
  const Eigen::Matrix3d R_from_to = R_body_map * to.T_map_body.linear();
  const Eigen::Vector3d& lever = measured.p_body_sensor;
  const Eigen::Vector3d p_from_sensor =
      R_body_map * (to.T_map_body.translation() - from.T_map_body.translation()) +
      R_from_to * lever;

  LinkFactor<3> factor;
  factor.residual = p_from_sensor - lever - measured.calibrated(to.velocity);
  factor.by_from.middleCols<3>(kPositionAt) = -Eigen::Matrix3d::Identity();
  factor.by_from.middleCols<3>(kRotationAt) = skew(p_from_sensor);
  factor.by_to.middleCols<3>(kPositionAt) = R_from_to;
  factor.by_to.middleCols<3>(kRotationAt) = -R_from_to * skew(lever);
  if (measured.source == VelocitySource::sensor) {
    factor.by_to.col(kScaleAt) = -(measured.way + measured.by_turn * to.velocity.turn);
    factor.by_to.middleCols<2>(kTurnAt) = -(1.0 + to.velocity.scale) * measured.by_turn;
  }

  const Eigen::LLT<Eigen::Matrix3d> whitening(measured.covariance);
  whitening.matrixL().solveInPlace(factor.residual);
  whitening.matrixL().solveInPlace(factor.by_from);
  whitening.matrixL().solveInPlace(factor.by_to);
  return factor;
}

RobustWeight velocity_kernel(const LinkFactor<3>& factor) {
  const double width = huber_width(3);
  return cauchy(factor.residual.squaredNorm(), width * width);
}

}  // namespace adit
