// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_database/odometry_chain.hpp"

#include <unordered_map>

namespace adit {

std::vector<Eigen::Isometry3d> odometry_chain(const std::vector<MapKeyframe>& keyframes,
                                              const PoseGraph& graph) {
  std::vector<Eigen::Isometry3d> poses;
  std::unordered_map<NodeId, std::size_t> positions;
  for (const MapKeyframe& keyframe : keyframes) {
    positions.emplace(keyframe.id, poses.size());
    poses.push_back(keyframe.T_map_keyframe);
  }
  std::vector<bool> known(poses.size(), false);
  for (const PoseEdge& edge : graph.edges()) {
    const auto from = positions.find(edge.from);
    const auto to = positions.find(edge.to);
    if (edge.kind != EdgeKind::odometry || from == positions.end() || to == positions.end() ||
        to->second <= from->second || known[to->second]) {
      continue;
    }
    poses[to->second] = poses[from->second] * edge.T_from_to;
    known[to->second] = true;
  }
  return poses;
}

}  // namespace adit
