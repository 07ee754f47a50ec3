// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How far loops move keyframes against each other, in standard deviations of what was known without
// them (docs/theory/loops.md).
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

/// A loop's relative pose against that of other edges.
struct LoopMove {
  double metres = 0.0;   ///< between the two
  double radians = 0.0;  ///< between the two
  double chi2 = 0.0;     ///< of 6 directions, with the covariances of both
  double path = 0.0;     ///< m, along the other edges

  /// The Mahalanobis distance: so many standard deviations.
  double sigmas() const;
};

/// By edge of the graph: each loop, whatever its status, against the graph before it came in, that
/// is the edges that were added before it, but for loops that came in with it: those that were
/// added without an edge of the odometry between them. Nothing for other edges, and where the graph
/// did not tie the two keyframes.
std::vector<std::optional<LoopMove>> moves_from_graph_before(const PoseGraph& graph);

/// The same against the odometry alone, for active loops.
std::vector<std::optional<LoopMove>> moves_from_odometry(const PoseGraph& graph);

/// The active loop that is farthest from where the odometry alone has it, in its standard
/// deviations; nothing where there is none.
std::optional<LoopMove> farthest_from_odometry(const PoseGraph& graph);

}  // namespace adit
