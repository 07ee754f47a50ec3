// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/keyframe_edge.hpp"

#include <Eigen/Cholesky>

namespace adit {
namespace {

// Errors of alignments of consecutive submaps (docs/theory/mapping.md): what the odometry's own
// alignments have, but that surfaces of two submaps are cut into other cells.
constexpr CovarianceModel kSubmapModel{
    .kappa = 0.3, .area = 0.016, .sigma_translation = 0.01, .sigma_rotation = 0.001};
// Nothing is known better than this.
constexpr double kLeastSigmaTranslation = 1e-3;  // m
constexpr double kLeastSigmaRotation = 1e-4;     // rad

Matrix6d symmetric_inverse(const Matrix6d& matrix) {
  const Matrix6d inverse = matrix.ldlt().solve(Matrix6d::Identity());
  return 0.5 * (inverse + inverse.transpose());
}

Matrix6d information_of(const KeyframeMotion& motion) {
  Matrix6d covariance = motion.covariance;
  covariance.diagonal().head<3>().array() += kLeastSigmaTranslation * kLeastSigmaTranslation;
  covariance.diagonal().tail<3>().array() += kLeastSigmaRotation * kLeastSigmaRotation;
  return symmetric_inverse(covariance);
}

}  // namespace

KeyframeMotion combined(const KeyframeMotion& odometry, const KeyframeMotion& aligned) {
  const Matrix6d by_odometry = information_of(odometry);
  const Matrix6d by_alignment = information_of(aligned);
  const Matrix6d covariance = symmetric_inverse(by_odometry + by_alignment);
  const Vector6d off = se3_log(odometry.T_from_to.inverse() * aligned.T_from_to);
  return {.T_from_to = odometry.T_from_to * se3_exp(covariance * (by_alignment * off)),
          .covariance = 2.0 * covariance};
}

KeyframeMotion motion_of(const RegistrationResult& alignment) {
  return {.T_from_to = alignment.T_target_source,
          .covariance = covariance(alignment, kSubmapModel)};
}

PoseEdge edge_of(NodeId from, NodeId to, const KeyframeMotion& motion) {
  return {.from = from,
          .to = to,
          .T_from_to = motion.T_from_to,
          .information = information_of(motion),
          .kind = EdgeKind::odometry};
}

}  // namespace adit
