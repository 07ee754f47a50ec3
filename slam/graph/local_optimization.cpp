// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/local_optimization.hpp"

#include <algorithm>
#include <set>

namespace adit {
namespace {

/// Whether an edge closes a cycle: then its residual and those of others disagree.
bool is_more_than_odometry(const PoseGraph& graph, const PoseEdge& edge) {
  const std::size_t from = graph.index_of(edge.from);
  const std::size_t to = graph.index_of(edge.to);
  return edge.kind != EdgeKind::odometry || std::max(from, to) - std::min(from, to) != 1;
}

}  // namespace

PoseGraph neighbourhood(const PoseGraph& graph, std::span<const NodeId> nodes) {
  const std::set<NodeId> inside(nodes.begin(), nodes.end());
  std::set<NodeId> all = inside;
  std::set<std::size_t> edges;
  for (const NodeId id : inside) {
    for (const std::size_t index : graph.edges_of(id)) {
      const PoseEdge& edge = graph.edges()[index];
      if (edge.status == EdgeStatus::active) {
        edges.insert(index);
        all.insert({edge.from, edge.to});
      }
    }
  }
  PoseGraph part(graph.planar());
  for (const NodeId id : all) {
    PoseNode node = graph.nodes()[graph.index_of(id)];
    node.fixed = node.fixed || !inside.contains(id);
    part.add_node(node);
  }
  for (const std::size_t index : edges) {
    part.add_edge(graph.edges()[index]);
  }
  return part;
}

LocalOptimization optimize_newest(const PoseGraph& graph, std::size_t window,
                                  const OptimizationSettings& settings) {
  LocalOptimization result;
  const std::size_t count = std::min(graph.nodes().size(), window + 1);
  for (std::size_t i = graph.nodes().size() - count; i < graph.nodes().size(); ++i) {
    result.nodes.push_back(graph.nodes()[i].id);
  }
  PoseGraph part = neighbourhood(graph, result.nodes);
  const bool decided = std::ranges::any_of(
      part.edges(), [&](const PoseEdge& edge) { return is_more_than_odometry(graph, edge); });
  for (const NodeId id : result.nodes) {
    result.poses.push_back(part.nodes()[part.index_of(id)].T_map_node);
  }
  if (!decided) {
    return result;
  }
  const OptimizedGraph optimized = optimize(part, settings);
  for (std::size_t i = 0; i < result.nodes.size(); ++i) {
    result.poses[i] = optimized.poses[part.index_of(result.nodes[i])];
  }
  result.report = optimized.report;
  return result;
}

GraphCorrection correction(const PoseGraph& snapshot, const OptimizedGraph& optimized) {
  GraphCorrection result;
  for (const PoseNode& node : snapshot.nodes()) {
    result.nodes.push_back(node.id);
  }
  result.poses = optimized.poses;
  if (!result.poses.empty()) {
    result.T_new_old =
        orthonormalized(result.poses.back() * snapshot.nodes().back().T_map_node.inverse());
  }
  return result;
}

PoseGraph corrected(PoseGraph graph, const GraphCorrection& correction) {
  std::vector<Eigen::Isometry3d> poses = poses_of(graph);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const PoseNode& node = graph.nodes()[i];
    const auto at = std::ranges::lower_bound(correction.nodes, node.id);
    if (node.fixed) {
      continue;
    }
    if (at != correction.nodes.end() && *at == node.id) {
      poses[i] = correction.poses[static_cast<std::size_t>(at - correction.nodes.begin())];
    } else if (correction.nodes.empty() || node.id > correction.nodes.back()) {
      poses[i] = orthonormalized(correction.T_new_old * node.T_map_node);
    }
  }
  graph.set_poses(poses);
  return graph;
}

}  // namespace adit
