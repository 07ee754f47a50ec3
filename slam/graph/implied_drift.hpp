// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Whether an odometry may have drifted by as much as a loop implies: by that, places that look
// alike are distinguished from places seen again (docs/theory/loops.md).
#pragma once

#include <optional>
#include <vector>

#include "adit/slam/graph/odometry_drift.hpp"
#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

class RelativePoses;

/// A loop: a measured pose of the later keyframe in the earlier one's frame.
struct ImpliedDrift {
  NodeId from = 0;  ///< the earlier keyframe
  NodeId to = 0;    ///< the later one
  Eigen::Isometry3d T_from_to = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();  ///< its own, right perturbation
  bool levelled = true;                    ///< both keyframes know their vertical
};

/// What a loop implies of the path between its keyframes; nothing where none ties them.
std::optional<DriftDifference> drift_difference(RelativePoses& relative, const ImpliedDrift& claim);

/// Between two places that know their vertical there is more tilt than an alignment may err by.
bool is_tilted(const Eigen::Isometry3d& T_from_to);

/// A loop implies that the stretch which led to the later keyframe is the one which led to the
/// earlier one, as far back as the two lie together and no accepted loop ties them. The drift has
/// to be plausible (OdometryDrift::excess()) for each such pair, and where both know their
/// vertical, nothing explains a tilt. On the way back the stretches are not followed. `measured`
/// has the edges' measurements: an optimum may have bent some of them for a loop far away. True
/// where no path ties the keyframes.
bool drift_explains(const PoseGraph& graph, RelativePoses& measured, const ImpliedDrift& claim,
                    const OdometryDrift& drift);

/// For each node, in the graph's order: whether an active loop goes from it or one before it to one
/// behind it, so that the odometry's edge to the next is one that loops have corrected.
std::vector<bool> within_loops(const PoseGraph& graph);

}  // namespace adit
