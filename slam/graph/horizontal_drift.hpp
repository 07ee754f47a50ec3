// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How far the odometry drifts in the level, by what fixes show of it (docs/theory/gnss.md).
#pragma once

#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

/// The same graph with the odometry's covariances counted `scale` times in the level: along the
/// world's horizontal plane and about its vertical. Those of height and tilt are as they were, and
/// so are edges that the odometry itself has at more than three times the usual standard deviation:
/// bridged, or along a tunnel.
PoseGraph with_horizontal_drift(const PoseGraph& graph, double scale);

/// Scales that the graph's fixes and loops allow: how probable these are, given the odometry, whose
/// covariances count so many times in the level, and the verticals (a variance component by
/// marginal likelihood). From the graph's optimum with scale 1 or near it, in one linear step each;
/// scales are half decades from 0.01 to 100. Both are 1 where fixes are of fewer than three
/// nodes or tell nothing of it, where nothing levels the map, so that a tilt could take what is in
/// the level, and where the equations cannot be solved.
struct HorizontalDrift {
  /// Within one standard deviation of the likeliest: what the map is bent by. Poor fixes tell
  /// little of the scale, and would bend a map that is better than they are.
  double smallest = 1.0;
  double largest = 1.0;  ///< that is not ruled out at 95 %: what covariances are to go by
};
HorizontalDrift horizontal_drift(const PoseGraph& graph);

}  // namespace adit
