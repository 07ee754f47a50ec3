// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Where to start the optimisation of a graph whose own poses are too far off.
#pragma once

#include <vector>

#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

/// Poses from fixed nodes (or a component's first) along the chain of edges whose rotations are
/// known best (shortest paths by variance). In the order of the graph's nodes; those of fixed
/// nodes, and of nodes without edges, stay.
std::vector<Eigen::Isometry3d> spanning_tree_poses(const PoseGraph& graph);

/// Rotations first: the least squares of R_i R_ij = R_j over all matrices, each brought back to the
/// nearest rotation, then positions by least squares given the rotations (chordal relaxation,
/// Martinec and Pajdla 2007, Carlone et al. 2015). Independent of the graph's poses but for those
/// that hold a component in place. Falls back to the spanning tree where a system is singular.
std::vector<Eigen::Isometry3d> chordal_poses(const PoseGraph& graph);

}  // namespace adit
