// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/merge_start.hpp"

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "adit/slam/mapping/start_place.hpp"

namespace adit {
namespace {

/// A pair of keyframes, by the graph's nodes: the nearest of both maps, in the first part of each.
struct NearestPair {
  std::size_t earlier = 0;
  std::size_t later = 0;
};

NearestPair nearest_pair(const PoseGraph& graph, std::size_t earlier_nodes) {
  const std::vector<std::size_t> part_of = connected_components(graph).component_of;
  NearestPair nearest{.later = earlier_nodes};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < earlier_nodes; ++i) {
    for (std::size_t k = earlier_nodes; k < graph.nodes().size(); ++k) {
      const double apart =
          (graph.nodes()[i].T_map_node.translation() - graph.nodes()[k].T_map_node.translation())
              .squaredNorm();
      if (part_of[i] == part_of.front() && part_of[k] == part_of[earlier_nodes] && apart < least) {
        least = apart;
        nearest = {.earlier = i, .later = k};
      }
    }
  }
  return nearest;
}

/// Where the later map lies in the earlier one, which is georeferenced, with what is not known of
/// one of its keyframes there: by its own place in the world or, where it has none, by its fixes.
/// Nothing: by neither.
std::optional<ExpectedStart> expected_in(const Georeference& earlier, const StoredMap& later,
                                         const Eigen::Isometry3d& T_later_keyframe,
                                         const GnssConfig& gnss) {
  if (later.georeference) {
    return expected_start(earlier, *later.georeference, T_later_keyframe);
  }
  StartByFixes fixes(earlier, gnss.correlation, gnss.height);
  for (const MapFix& fix : later.fixes) {
    fixes.add({&fix, 1}, later.graph.nodes()[later.graph.index_of(fix.keyframe)].T_map_node);
  }
  return fixes.find(Eigen::Vector3d::UnitZ(), T_later_keyframe);
}

}  // namespace

bool place_in_earlier(PoseGraph& graph, std::size_t earlier_nodes, const Georeference& earlier,
                      const StoredMap& later, const GnssConfig& gnss) {
  const auto expected = expected_in(earlier, later, graph.nodes().back().T_map_node, gnss);
  if (!expected) {
    return false;
  }
  for (std::size_t i = earlier_nodes; i < graph.nodes().size(); ++i) {
    const PoseNode& node = graph.nodes()[i];
    graph.set_pose(node.id, orthonormalized(expected->T_map_odom * node.T_map_node));
  }
  const NearestPair pair = nearest_pair(graph, earlier_nodes);
  const PoseNode& from = graph.nodes()[pair.earlier];
  const PoseNode& to = graph.nodes()[pair.later];
  const Eigen::Isometry3d T_later_to = expected->T_map_odom.inverse() * to.T_map_node;
  graph.add_edge(start_edge(from, to, expected_in(earlier, later, T_later_to, gnss)->covariance));
  return true;
}

PoseGraph measured_alone(const PoseGraph& graph) {
  PoseGraph measured;
  for (const PoseNode& node : graph.nodes()) {
    measured.add_node(node);
  }
  for (const LevelledNode& level : graph.levels()) {
    measured.add_level(level);
  }
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.kind != EdgeKind::start) {
      measured.add_edge(edge);
    }
  }
  return measured;
}

}  // namespace adit
