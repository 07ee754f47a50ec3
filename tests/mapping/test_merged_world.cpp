// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What ties some of the merged maps to the Earth gives all of them a place there.
#include "adit/slam/mapping/merged_world.hpp"

#include <gtest/gtest.h>

#include "adit/tests/mapping/graph_support.hpp"

namespace adit::merged_world_test {
namespace {

constexpr NodeId kNodes = 12;  // of each map
const Geodetic kOrigin{.latitude = 48.0, .longitude = 11.0, .altitude = 500.0};

/// Turned by a quarter and moved.
Eigen::Isometry3d T_world_map() {
  Eigen::Isometry3d pose(Eigen::AngleAxisd(0.5 * 3.14159265358979, Eigen::Vector3d::UnitZ()));
  pose.translation() = Eigen::Vector3d(100.0, -20.0, 3.0);
  return pose;
}

/// Two maps of the same way, 3 m a node, in an arc: loops tie them, node by node.
PoseGraph merged_graph() {
  PoseGraph graph;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const Eigen::Isometry3d way = test::step(3.0, 0.15);
  for (NodeId map = 0; map < 2; ++map) {
    pose = Eigen::Isometry3d::Identity();
    for (NodeId i = 0; i < kNodes; ++i, pose = pose * way) {
      const NodeId id = map * kNodes + i;
      graph.add_node({.id = id, .T_map_node = pose});
      graph.add_level({.node = id, .information = 1e4});
      if (i > 0) {
        graph.add_edge(test::edge(id - 1, id, way, 1e4));
      }
      if (map > 0) {
        PoseEdge loop = test::edge(i, id, Eigen::Isometry3d::Identity(), 1e4);
        loop.kind = EdgeKind::loop;
        graph.add_edge(loop);
      }
    }
  }
  return graph;
}

Geodetic place_of(const PoseGraph& graph, NodeId node) {
  return WorldFrame(kOrigin).place_of(T_world_map() *
                                      graph.nodes()[graph.index_of(node)].T_map_node.translation());
}

std::vector<MapFix> fixes_of(const PoseGraph& graph, NodeId first) {
  std::vector<MapFix> fixes;
  for (NodeId i = 0; i < kNodes; ++i) {
    fixes.push_back({.id = i + 1,
                     .keyframe = first + i,
                     .stamp = std::chrono::seconds(10 * i),
                     .kind = GnssFixKind::ground_augmented,
                     .place = place_of(graph, first + i),
                     .covariance = 1e-4 * Eigen::Matrix3d::Identity(),
                     .path = 3.0 * static_cast<double>(i)});
  }
  return fixes;
}

void expect_placed(const MergedWorld& merged) {
  ASSERT_TRUE(merged.georeference.has_value());
  const WorldFrame frame(merged.georeference->origin);
  const PoseGraph truth = merged_graph();
  for (const PoseNode& node : merged.graph.nodes()) {
    const Eigen::Vector3d off = merged.georeference->T_world_map * node.T_map_node.translation() -
                                frame.position_of(place_of(truth, node.id));
    EXPECT_LT(off.norm(), 0.02) << "node " << node.id;
  }
}

TEST(MergedWorld, FixesOfTheSecondMapPlaceBoth) {
  const PoseGraph graph = merged_graph();
  const MergedWorld merged = place_in_world(
      graph, {{.first = 0}, {.first = kNodes, .fixes = fixes_of(graph, kNodes)}}, {});
  expect_placed(merged);
  ASSERT_EQ(merged.fixes.size(), static_cast<std::size_t>(kNodes));
  EXPECT_EQ(std::ranges::count(merged.fixes, FixVerdict::used, &MapFix::verdict), kNodes);
}

TEST(MergedWorld, FixesOfBothCountTogetherWithNewNumbers) {
  const PoseGraph graph = merged_graph();
  const MergedWorld merged = place_in_world(graph,
                                            {{.first = 0, .fixes = fixes_of(graph, 0)},
                                             {.first = kNodes, .fixes = fixes_of(graph, kNodes)}},
                                            {});
  expect_placed(merged);
  ASSERT_EQ(merged.fixes.size(), static_cast<std::size_t>(2 * kNodes));
  for (std::size_t i = 0; i < merged.fixes.size(); ++i) {
    EXPECT_EQ(merged.fixes[i].id, static_cast<int64_t>(i) + 1);
  }
  EXPECT_GT(merged.fixes.back().path, merged.fixes[kNodes - 1].path);
}

TEST(MergedWorld, ControlPointsOfTheSecondMapPlaceBoth) {
  const PoseGraph graph = merged_graph();
  std::vector<ControlPoint> control;
  for (const NodeId node : {kNodes, kNodes + 5, kNodes + 11}) {
    control.push_back(
        {.name = std::to_string(node), .keyframe = node, .place = place_of(graph, node)});
  }
  // The second map's own frame is not the merged one's.
  const Eigen::Isometry3d T_part_merged = test::step(7.0, 1.0);
  const MergedWorld merged = place_in_world(
      graph,
      {{.first = 0},
       {.first = kNodes,
        .T_part_first = T_part_merged * graph.nodes()[kNodes].T_map_node,
        .control = control,
        .georeference = Georeference{.origin = kOrigin,
                                     .T_world_map = T_world_map() * T_part_merged.inverse()}}},
      {});
  expect_placed(merged);
  EXPECT_EQ(merged.control.size(), 3U);
}

TEST(MergedWorld, WithoutTiesThereIsNoPlace) {
  const PoseGraph graph = merged_graph();
  const MergedWorld merged = place_in_world(graph, {{.first = 0}, {.first = kNodes}}, {});
  EXPECT_FALSE(merged.georeference.has_value());
  EXPECT_EQ(merged.graph.nodes().size(), graph.nodes().size());
}

TEST(MergedWorld, WhatIsTiedToNothingPlacesNothing) {
  PoseGraph graph = merged_graph();
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    if (graph.edges()[i].kind == EdgeKind::loop) {
      graph.set_status(i, EdgeStatus::revoked);
    }
  }
  const MergedWorld merged = place_in_world(
      graph, {{.first = 0}, {.first = kNodes, .fixes = fixes_of(graph, kNodes)}}, {});
  EXPECT_FALSE(merged.georeference.has_value());
}

}  // namespace
}  // namespace adit::merged_world_test
