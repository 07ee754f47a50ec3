// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/keyframe_edge.hpp"

#include "adit/slam/core/lie.hpp"

namespace adit {
namespace {

// Errors of alignments of consecutive submaps (docs/theory/mapping.md): what the odometry's own
// alignments have, but that surfaces of two submaps are cut into other cells.
constexpr CovarianceModel kSubmapModel{
    .kappa = 0.3, .area = 0.016, .sigma_translation = 0.01, .sigma_rotation = 0.001};
// Variances of an alignment's errors that last are those times this: they are alike from submap to
// submap, as what is seen is (docs/theory/mapping.md).
constexpr double kAlike = 50.0;
// Nothing is known better than this.
constexpr double kLeastSigmaTranslation = 1e-3;  // m
constexpr double kLeastSigmaRotation = 1e-4;     // rad

Matrix6d information_of(Matrix6d covariance) {
  covariance.diagonal().head<3>().array() += kLeastSigmaTranslation * kLeastSigmaTranslation;
  covariance.diagonal().tail<3>().array() += kLeastSigmaRotation * kLeastSigmaRotation;
  return symmetric_inverse(covariance);
}

}  // namespace

Matrix6d in_keyframe_axes(const Matrix6d& covariance, const Eigen::Isometry3d& T_keyframe_lidar) {
  const Matrix6d to_keyframe = adjoint(T_keyframe_lidar);
  return to_keyframe * covariance * to_keyframe.transpose();
}

KeyframeMotion odometry_motion(const UncertainPose& from, const UncertainPose& to,
                               const Eigen::Isometry3d& T_from_to,
                               const Eigen::Isometry3d& T_keyframe_lidar) {
  // The drift is that of the submap: between two poses without errors of their own.
  const Matrix6d lasting =
      motion_covariance({from.stamp, from.T_map_lidar, {.drift = from.uncertainty.drift}},
                        {to.stamp, to.T_map_lidar, {.drift = to.uncertainty.drift}});
  return {.T_from_to = T_from_to,
          .covariance = in_keyframe_axes(motion_covariance(from, to), T_keyframe_lidar),
          .lasting = in_keyframe_axes(lasting, T_keyframe_lidar)};
}

KeyframeMotion combined(const KeyframeMotion& odometry, const KeyframeMotion& aligned) {
  const Matrix6d by_alignment = information_of(aligned.lasting);
  const Matrix6d lasting = symmetric_inverse(information_of(odometry.lasting) + by_alignment);
  const Vector6d off = se3_log(odometry.T_from_to.inverse() * aligned.T_from_to);
  const Matrix6d sum = information_of(odometry.covariance) + information_of(aligned.covariance);
  return {.T_from_to = odometry.T_from_to * se3_exp(lasting * (by_alignment * off)),
          .covariance = 2.0 * symmetric_inverse(sum),
          .lasting = lasting};
}

KeyframeMotion motion_of(const RegistrationResult& alignment) {
  const Matrix6d known = covariance(alignment, kSubmapModel);
  return {.T_from_to = alignment.T_target_source, .covariance = known, .lasting = kAlike * known};
}

PoseEdge edge_of(NodeId from, NodeId to, const KeyframeMotion& motion) {
  return {.from = from,
          .to = to,
          .T_from_to = motion.T_from_to,
          .information = information_of(motion.covariance),
          .kind = EdgeKind::odometry};
}

}  // namespace adit
