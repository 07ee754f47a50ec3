// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

/// Covariances (m^2, world axes) of where nodes lie in the world: the inverse of the whole graph's
/// information, of edges, fixes, headings and levels, where it is. Empty where that is singular.
/// One for each of the nodes, which are of the part of the graph that fixes tie to the world.
std::vector<Eigen::Matrix3d> world_covariances(const PoseGraph& graph,
                                               std::span<const NodeId> nodes);

/// Of T_world_map, [rho, phi], with the map's own shape taken as known.
Matrix6d covariance_of_world(const PoseGraph& graph);

}  // namespace adit
