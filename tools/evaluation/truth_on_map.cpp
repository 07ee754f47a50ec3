// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/truth_on_map.hpp"

#include <algorithm>
#include <optional>

#include "adit/slam/graph/pose_graph.hpp"
#include "adit/tools/evaluation/evaluate_alignment.hpp"
#include "adit/tools/evaluation/true_keyframes.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

/// Keyframes of one part of a map that the truth covers, one beside the other.
struct CoveredPart {
  std::vector<NodeId> ids;
  std::vector<Eigen::Isometry3d> in_map;
  std::vector<Eigen::Isometry3d> in_world;
  Nanoseconds first{0};
  Nanoseconds last{0};
};

std::vector<CoveredPart> covered_parts(const MapDatabase& map, const Trajectory& truth) {
  const std::map<NodeId, TrueKeyframe> covered = true_keyframes(map, map.file(), truth);
  const PoseGraph graph = map.graph();
  const GraphComponents components = connected_components(graph);
  std::vector<CoveredPart> parts(components.components.size());
  for (std::size_t i = 0; i < graph.nodes().size(); ++i) {
    const PoseNode& node = graph.nodes()[i];
    const auto found = covered.find(node.id);
    if (found == covered.end()) {
      continue;
    }
    CoveredPart& part = parts[components.component_of[i]];
    const Nanoseconds stamp = found->second.stamp;
    part.first = part.ids.empty() ? stamp : std::min(part.first, stamp);
    part.last = part.ids.empty() ? stamp : std::max(part.last, stamp);
    part.ids.push_back(node.id);
    part.in_map.push_back(node.T_map_node);
    part.in_world.push_back(found->second.T_world_keyframe);
  }
  std::erase_if(parts, [](const CoveredPart& part) { return part.ids.empty(); });
  return parts;
}

}  // namespace

TruthOnMap truth_on_map(const MapDatabase& map, const Trajectory& truth) {
  const std::vector<CoveredPart> parts = covered_parts(map, truth);
  if (parts.empty()) {
    throw InputError(truth.file, {}, "it covers no keyframe of " + map.file().string(),
                     "Its times must be those of the recording");
  }
  TruthOnMap result;
  for (const CoveredPart& part : parts) {
    std::optional<Similarity> T_map_world = align(part.in_world, part.in_map, Alignment::se3);
    if (!T_map_world) {
      T_map_world = align(part.in_world, part.in_map, Alignment::origin);
    }
    for (std::size_t i = 0; i < part.ids.size(); ++i) {
      const Eigen::Isometry3d true_pose = *T_map_world * part.in_world[i];
      result.errors[part.ids[i]] = (true_pose.translation() - part.in_map[i].translation()).norm();
    }
    for (const StampedPose& pose : truth.poses) {
      if (pose.stamp >= part.first && pose.stamp <= part.last) {
        result.path.push_back((*T_map_world * pose.pose).translation());
      }
    }
  }
  return result;
}

}  // namespace adit
