// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/map_shares.hpp"

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"

namespace adit {
namespace {

PoseGraph two_keyframes() {
  PoseGraph graph;
  graph.add_node({.id = 0});
  PoseNode second{.id = 1};
  second.T_map_node.translation() = Eigen::Vector3d(3.0, 1.0, 0.5);
  second.T_map_node.linear() = so3_exp({0.1, -0.2, 0.7});
  graph.add_node(second);
  return graph;
}

PoseEdge measured_edge(const PoseGraph& graph, EdgeKind kind, double information) {
  return {.from = 0,
          .to = 1,
          .T_from_to = graph.nodes()[1].T_map_node,
          .information = information * Matrix6d::Identity(),
          .kind = kind};
}

TEST(MapShares, OfTwoMeasurementsAreTheirWeights) {
  PoseGraph graph = two_keyframes();
  graph.add_edge(measured_edge(graph, EdgeKind::odometry, 100.0));
  graph.add_edge(measured_edge(graph, EdgeKind::loop, 300.0));
  const auto shares = map_shares(graph);
  ASSERT_TRUE(shares);
  for (const MapPart part : {MapPart::level, MapPart::height, MapPart::yaw}) {
    EXPECT_NEAR((*shares)(MapSource::odometry, part), 0.25, 1e-6);
    EXPECT_NEAR((*shares)(MapSource::loops, part), 0.75, 1e-6);
    EXPECT_NEAR((*shares)(MapSource::fixes, part), 0.0, 1e-6);
  }
}

TEST(MapShares, FixesCountWhereTheOdometryIsWorse) {
  PoseGraph graph = two_keyframes();
  graph.add_edge(measured_edge(graph, EdgeKind::odometry, 1.0));
  for (const PoseNode& node : graph.nodes()) {
    for (const Eigen::Vector3d& p :
         {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(9.0, 0.0, 0.0),
          Eigen::Vector3d(0.0, 9.0, 0.0), Eigen::Vector3d(0.0, 0.0, 9.0)}) {
      graph.add_fix({.node = node.id,
                     .p_node = p,
                     .p_world = node.T_map_node * p,
                     .information = 1e4 * Eigen::Matrix3d::Identity()});
    }
  }
  const auto shares = map_shares(graph);
  ASSERT_TRUE(shares);
  EXPECT_GT((*shares)(MapSource::fixes, MapPart::level), 0.99);
  EXPECT_GT((*shares)(MapSource::fixes, MapPart::yaw), 0.99);
  double total = 0.0;
  for (std::size_t i = 0; i < kMapSources; ++i) {
    total += shares->of[i][0];
  }
  EXPECT_NEAR(total, 1.0, 1e-6);
}

TEST(MapShares, OneKeyframeHasNone) {
  PoseGraph graph;
  graph.add_node({.id = 0});
  EXPECT_FALSE(map_shares(graph));
}

}  // namespace
}  // namespace adit
