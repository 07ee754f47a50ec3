// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adit/slam/core/lie.hpp"
#include "adit/slam/graph/pose_graph.hpp"
#include "adit/slam/odometry/pose_uncertainty.hpp"
#include "adit/slam/registration/registration.hpp"

namespace adit {

/// What is known of the motion from one keyframe to the next.
struct KeyframeMotion {
  Eigen::Isometry3d T_from_to = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Identity();  ///< right perturbation [rho, phi], axes of `to`
  /// The part of it that all later poses share. The rest belongs to these two poses alone: what a
  /// sweep's alignment with the rolling submap errs by, the next sweep's knows nothing of.
  Matrix6d lasting = Matrix6d::Identity();
};

/// A covariance of a pose of the lidar as one of its keyframe: the same place with other axes.
Matrix6d in_keyframe_axes(const Matrix6d& covariance, const Eigen::Isometry3d& T_keyframe_lidar);

/// The odometry's motion between two of its poses, `T_keyframe_lidar` being the later keyframe's.
KeyframeMotion odometry_motion(const UncertainPose& from, const UncertainPose& to,
                               const Eigen::Isometry3d& T_from_to,
                               const Eigen::Isometry3d& T_keyframe_lidar);

/// Both together. Errors of alignments last, so that the two are weighted by what lasts of theirs:
/// directions that the alignment does not hold are the odometry's, and where the odometry hardly
/// drifts it is hardly moved. The two have looked at the same sweeps, so that they are not
/// independent: together they are known as well as the average of both informations says.
KeyframeMotion combined(const KeyframeMotion& odometry, const KeyframeMotion& aligned);

/// The motion that an alignment of the later submap with the earlier one has found; its status must
/// be usable.
KeyframeMotion motion_of(const RegistrationResult& alignment);

/// As an edge of the graph.
PoseEdge edge_of(NodeId from, NodeId to, const KeyframeMotion& motion);

}  // namespace adit
