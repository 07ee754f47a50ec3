// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_edits/loop_drift.hpp"

#include <algorithm>

#include "adit/slam/core/lie.hpp"

namespace adit {
namespace {

PoseBeside beside(const Eigen::Isometry3d& T_from_to, const LoopCandidate& loop) {
  const Eigen::Isometry3d off = T_from_to.inverse() * loop.T_from_to;
  return {.T_from_to = T_from_to,
          .metres = off.translation().norm(),
          .radians = rotation_angle(off.linear())};
}

}  // namespace

std::map<NodeId, ChainPlace> chain_places(const PoseGraph& graph) {
  std::map<NodeId, ChainPlace> places;
  std::size_t chains = 0;
  for (const PoseNode& node : graph.nodes()) {
    const auto edges = graph.edges_of(node.id);
    const auto before = std::ranges::find_if(edges, [&](std::size_t i) {
      const PoseEdge& edge = graph.edges()[i];
      return edge.kind == EdgeKind::odometry && edge.to == node.id && places.contains(edge.from);
    });
    if (before == edges.end()) {
      places[node.id] = {.chain = chains++};
      continue;
    }
    const PoseEdge& edge = graph.edges()[*before];
    const ChainPlace& from = places.at(edge.from);
    places[node.id] = {.chain = from.chain,
                       .pose = from.pose * edge.T_from_to,
                       .path = from.path + edge.T_from_to.translation().norm()};
  }
  return places;
}

LoopDrift drift_of(const LoopCandidate& loop, const std::map<NodeId, ChainPlace>& places,
                   const PoseGraph& graph) {
  const ChainPlace& from = places.at(loop.from);
  const ChainPlace& to = places.at(loop.to);
  const auto node = [&](NodeId id) -> const Eigen::Isometry3d& {
    return graph.nodes()[graph.index_of(id)].T_map_node;
  };
  LoopDrift drift{.map = beside(node(loop.from).inverse() * node(loop.to), loop)};
  if (from.chain == to.chain) {
    drift.odometry = beside(from.pose.inverse() * to.pose, loop);
    drift.path = to.path - from.path;
  }
  return drift;
}

}  // namespace adit
