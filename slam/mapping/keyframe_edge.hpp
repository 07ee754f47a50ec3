// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adit/slam/core/lie.hpp"
#include "adit/slam/mapping/pose_graph.hpp"
#include "adit/slam/registration/registration.hpp"

namespace adit {

/// What is known of the motion from one keyframe to the next.
struct KeyframeMotion {
  Eigen::Isometry3d T_from_to = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Identity();  ///< right perturbation [rho, phi], axes of `to`
};

/// Both together, each weighted by its information: directions that the alignment of the submaps
/// does not hold are the odometry's. The two have looked at the same sweeps, so that they are not
/// independent: together they count as much as the average of both.
KeyframeMotion combined(const KeyframeMotion& odometry, const KeyframeMotion& aligned);

/// The motion that an alignment of the later submap with the earlier one has found; its status must
/// be usable.
KeyframeMotion motion_of(const RegistrationResult& alignment);

/// As an edge of the graph.
PoseEdge edge_of(NodeId from, NodeId to, const KeyframeMotion& motion);

}  // namespace adit
