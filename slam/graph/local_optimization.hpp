// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The newest part of a growing graph by itself, and what an optimisation of the whole, begun
// earlier, does to the nodes that have come since.
#pragma once

#include <span>
#include <vector>

#include "adit/slam/graph/solver.hpp"

namespace adit {

/// The part of a graph that decides about these nodes: they themselves, their neighbours, which are
/// fixed there, and the active edges that touch at least one of them.
PoseGraph neighbourhood(const PoseGraph& graph, std::span<const NodeId> nodes);

struct LocalOptimization {
  std::vector<NodeId> nodes;             ///< those that were free
  std::vector<Eigen::Isometry3d> poses;  ///< their poses
  OptimizationReport report;             ///< the neighbourhood's optimisation
};

/// Optimises the newest `window` + 1 nodes with their neighbours fixed. Nothing to do where no edge
/// but those of the odometry in their order reaches them: the poses are at the minimum already.
LocalOptimization optimize_newest(const PoseGraph& graph, std::size_t window,
                                  const OptimizationSettings& settings);

/// What an optimisation of a snapshot changes in the graph that has grown since.
struct GraphCorrection {
  std::vector<NodeId> nodes;             ///< the snapshot's nodes, in order
  std::vector<Eigen::Isometry3d> poses;  ///< theirs now
  /// Moves what came after the snapshot's last node, in the map frame, so that it keeps its place
  /// relative to that node. What else is in the odometry's frame moves with it.
  Eigen::Isometry3d T_new_old = Eigen::Isometry3d::Identity();
};
GraphCorrection correction(const PoseGraph& snapshot, const OptimizedGraph& optimized);

/// The graph with the correction. Nodes that have gone since are passed over; fixed ones stay.
PoseGraph corrected(PoseGraph graph, const GraphCorrection& correction);

}  // namespace adit
