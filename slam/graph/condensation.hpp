// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Large graphs are mostly chains: stretches of nodes that only the odometry ties. A chain counts
// like one edge between its ends (condensed measurement, after Lazaro et al. 2013), so the ends are
// optimised first and the nodes between follow.
#pragma once

#include <vector>

#include "adit/slam/graph/solver.hpp"

namespace adit {

/// Nodes that follow each other, tied by odometry edges alone; positions in the whole graph.
struct Chain {
  std::vector<std::size_t> nodes;  ///< both ends included
  std::vector<std::size_t> edges;  ///< one fewer
};

struct CondensedGraph {
  PoseGraph graph;            ///< the nodes that are not inside a chain; chains as edges
  std::vector<Chain> chains;  ///< each with at least three nodes
};

/// Inside a chain are nodes that may move, have two active edges, both of odometry, that know all
/// directions, and nothing that ties them to the world. `convention` is the one that informations
/// belong to.
CondensedGraph condensed(const PoseGraph& graph, ResidualConvention convention);

/// Poses of the whole graph from those of the condensed one: what is left at the end of a chain is
/// shared out by the covariances of its edges.
std::vector<Eigen::Isometry3d> expanded(const PoseGraph& graph, const CondensedGraph& condensed,
                                        const std::vector<Eigen::Isometry3d>& poses,
                                        ResidualConvention convention);

/// optimize(), by way of the condensed graph where the graph has more than `beyond` nodes and at
/// least half of them are inside chains. The same minimum; iterations count those of both graphs.
OptimizedGraph optimize_condensed(const PoseGraph& graph, const OptimizationSettings& settings,
                                  std::size_t beyond = 20000);

}  // namespace adit
