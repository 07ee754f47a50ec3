// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Whether the odometry may have drifted by as much as a loop claims: the sign by which places that
// look alike are told from places seen again (docs/theory/loops.md).
#pragma once

#include "adit/slam/mapping/pose_graph.hpp"

namespace adit {

/// What an odometry drifts by at the most, far beyond what its covariances say.
struct DriftLimits {
  double aside = 0.05;   ///< m, horizontally, a metre of path
  double height = 0.15;  ///< m a metre of path
  double turn = 0.0035;  ///< rad a metre of path (0.2 degrees)
  double tilt = 0.035;   ///< rad between two places that know their vertical, whatever the path
  // What a pair of places that are taken for the same may be apart:
  double least_distance = 0.5;  ///< m
  double least_turn = 0.05;     ///< rad
};

/// `error` is what the poses of two places, a path of so many m apart, would have drifted by; its
/// first frame has z up. Its tilt does not count: an optimisation may have put it there.
bool is_possible_drift(const Eigen::Isometry3d& error, double path, const DriftLimits& limits = {});

/// A loop claims that the stretch that led to the later keyframe is the one that led to the earlier
/// one, as far back as the two lie together: the drift has to be possible for each such pair. (On
/// the way back the stretches are followed no farther: drift grows along them, and how, no loop
/// says.) Paths are the shortest along the graph's edges, loops included: drift since then is what
/// is claimed. True where there is none between the two keyframes.
bool drift_explains(const PoseGraph& graph, NodeId from, NodeId to,
                    const Eigen::Isometry3d& T_from_to, const DriftLimits& limits = {});

}  // namespace adit
