// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/loops/loop_move.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "adit/tests/mapping/graph_support.hpp"

namespace adit {
namespace {

constexpr NodeId kNodes = 20;
constexpr double kInformation = 1e4;  // 1/m^2, 1/rad^2: 1 cm, 10 mrad

/// A straight path of nodes a metre apart.
PoseGraph path() {
  PoseGraph graph;
  for (NodeId id = 0; id < kNodes; ++id) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation().x() = static_cast<double>(id);
    graph.add_node({.id = id, .T_map_node = pose});
    if (id > 0) {
      graph.add_edge(test::edge(id - 1, id, test::step(1.0, 0.0), kInformation));
    }
  }
  return graph;
}

/// From the first node to `to`, `aside` m from where the odometry has it.
PoseEdge loop_aside(NodeId to, double aside) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(static_cast<double>(to), 0.0, aside);
  PoseEdge edge = test::edge(0, to, pose, kInformation);
  edge.kind = EdgeKind::loop;
  return edge;
}

TEST(LoopMove, IsInStandardDeviationsOfTheOdometry) {
  PoseGraph graph = path();
  EXPECT_FALSE(farthest_from_odometry(graph));
  graph.add_edge(loop_aside(10, 0.02));
  const auto little = farthest_from_odometry(graph);
  ASSERT_TRUE(little);
  EXPECT_NEAR(little->metres, 0.02, 1e-9);
  EXPECT_NEAR(little->path, 10.0, 1e-9);
  EXPECT_LT(little->sigmas(), 1.0);
  graph.add_edge(loop_aside(12, 4.0));
  const auto much = farthest_from_odometry(graph);
  ASSERT_TRUE(much);
  EXPECT_NEAR(much->metres, 4.0, 1e-9);
  EXPECT_GT(much->sigmas(), 5.0);
  EXPECT_NEAR(much->chi2, much->sigmas() * much->sigmas(), 1e-9);
  graph.set_status(graph.edges().size() - 1, EdgeStatus::revoked);
  EXPECT_NEAR(farthest_from_odometry(graph)->metres, 0.02, 1e-9) << "a revoked loop moves nothing";
}

TEST(LoopMove, IsAgainstTheGraphBeforeTheLoopAndNotAgainstThoseThatCameWithIt) {
  PoseGraph graph = path();
  graph.add_edge(loop_aside(10, 1.0));
  graph.add_edge(loop_aside(11, 1.0));  // with it
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation().x() = static_cast<double>(kNodes);
  graph.add_node({.id = kNodes, .T_map_node = pose});
  graph.add_edge(test::edge(kNodes - 1, kNodes, test::step(1.0, 0.0), kInformation));
  graph.add_edge(loop_aside(12, 1.0));
  const auto moves = moves_from_graph_before(graph);
  ASSERT_EQ(moves.size(), graph.edges().size());
  EXPECT_FALSE(moves.front()) << "of the odometry";
  const std::size_t first = kNodes - 1;
  ASSERT_TRUE(moves[first] && moves[first + 1] && moves.back());
  EXPECT_NEAR(moves[first]->metres, 1.0, 1e-9);
  EXPECT_NEAR(moves[first + 1]->metres, 1.0, 1e-9) << "both came together";
  EXPECT_NEAR(moves.back()->metres, 0.0, 1e-6) << "the loops before it had said so";
  EXPECT_LT(moves.back()->path, 15.0);
}

TEST(LoopMove, OfPartsThatNothingTiesIsNothing) {
  PoseGraph graph = path();
  graph.add_node({.id = 100});
  PoseEdge across = loop_aside(10, 0.0);
  across.to = 100;
  graph.add_edge(across);
  EXPECT_FALSE(moves_from_graph_before(graph).back());
  EXPECT_FALSE(farthest_from_odometry(graph));
}

}  // namespace
}  // namespace adit
