// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/loop_optimization.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/mapping/graph_support.hpp"

namespace adit {
namespace {

/// Round a square of 40 m, a metre a keyframe, with the way of each edge of the odometry changed by
/// `drift`.
struct Square {
  explicit Square(const Eigen::Isometry3d& drift) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    Eigen::Isometry3d believed = pose;
    for (NodeId id = 0; id <= 40; ++id) {
      truth.push_back(pose);
      graph.add_node({.id = id, .T_map_node = believed});
      if (id > 0) {
        PoseEdge edge = test::edge(id - 1, id, ways.back());
        edge.information.diagonal() << 1e4, 1e4, 1e4, 1e5, 1e5, 1e5;
        graph.add_edge(edge);
      }
      const Eigen::Isometry3d way = test::step(1.0, id % 10 == 9 ? 0.5 * std::numbers::pi : 0.0);
      ways.push_back(way * drift);
      pose = pose * way;
      believed = believed * ways.back();
    }
  }

  /// Known to 3 cm; `off` is what it is wrong by.
  void add_loop(std::size_t from, std::size_t to,
                const Eigen::Isometry3d& off = Eigen::Isometry3d::Identity()) {
    PoseEdge loop = test::edge(static_cast<NodeId>(from), static_cast<NodeId>(to),
                               truth[from].inverse() * truth[to] * off);
    loop.information.diagonal() << 1e3, 1e3, 1e3, 1e5, 1e5, 1e5;
    loop.kind = EdgeKind::loop;
    graph.add_edge(loop);
  }

  void add_loops_at_the_end() {
    for (std::size_t i = 0; i < 3; ++i) {
      add_loop(i, 38 + i);
    }
  }

  double error_of(const std::vector<Eigen::Isometry3d>& poses, std::size_t i) const {
    return (poses[i].translation() - truth[i].translation()).norm();
  }

  double worst_of(const std::vector<Eigen::Isometry3d>& poses) const {
    double worst = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      worst = std::max(worst, error_of(poses, i));
    }
    return worst;
  }

  PoseGraph graph;
  std::vector<Eigen::Isometry3d> truth;
  std::vector<Eigen::Isometry3d> ways;
};

TEST(OptimizeWithLoops, ARightLoopCorrectsMuchDriftAndAWrongOneNothing) {
  Square square(test::step(0.0, 0.002));
  EXPECT_GT(square.error_of(poses_of(square.graph), 40), 0.5);
  square.add_loops_at_the_end();
  const LoopOptimum right = optimize_with_loops(square.graph);
  EXPECT_LT(square.error_of(right.poses, 40), 0.1);
  EXPECT_EQ(right.odometry_scale, 1.0) << "the drift is one that the covariances allow for";
  for (std::size_t i = 40; i < 43; ++i) {
    EXPECT_LT(right.report.edges[i]->chi2, kLoopReview);
  }
  square.add_loop(5, 35, test::step(4.0));
  const LoopOptimum both = optimize_with_loops(square.graph);
  EXPECT_LT(square.error_of(both.poses, 40), 0.15);
  EXPECT_EQ(both.odometry_scale, 1.0);
  EXPECT_GT(both.report.edges.back()->chi2, kLoopReview) << "the review takes it back";
}

// Two degrees too far about each metre, which the covariances call impossible.
TEST(OptimizeWithLoops, DriftOfAllEdgesIsSharedOutAmongThem) {
  Square square(test::step(0.0, 0.035));
  const double before = square.worst_of(poses_of(square.graph));
  square.add_loops_at_the_end();
  const LoopOptimum found = optimize_with_loops(square.graph);
  EXPECT_GT(found.odometry_scale, 10.0);
  EXPECT_LT(square.worst_of(found.poses), 0.1 * before);
  for (std::size_t i = 40; i < 43; ++i) {
    EXPECT_LT(found.report.edges[i]->chi2, kLoopReview);
  }
}

// Out and back, with a loop to each place of the way out. Each metre turns and climbs by ten
// standard deviations of its edge: the kernel would rather do without all loops than bend them all.
TEST(OptimizeWithLoops, LoopsAreNotAllWrongWhereTheOdometryIs) {
  constexpr NodeId kThere = 29;
  constexpr NodeId kBack = 2 * kThere + 1;
  PoseGraph graph;
  std::vector<Eigen::Isometry3d> truth;
  Eigen::Isometry3d believed = Eigen::Isometry3d::Identity();
  const Eigen::Isometry3d drift =
      Eigen::Translation3d(0.0, 0.0, 0.1) * Eigen::AngleAxisd(0.03, Eigen::Vector3d::UnitZ());
  for (NodeId id = 0; id <= kBack; ++id) {
    truth.push_back(test::step(static_cast<double>(id <= kThere ? id : kBack - id)));
    if (id > 0) {
      const std::size_t at = static_cast<std::size_t>(id);
      PoseEdge edge = test::edge(id - 1, id, truth[at - 1].inverse() * truth[at] * drift);
      edge.information.diagonal() << 1e6, 1e6, 1e6, 1e7, 1e7, 1e7;
      believed = believed * edge.T_from_to;
      graph.add_node({.id = id, .T_map_node = believed});
      graph.add_edge(edge);
    } else {
      graph.add_node({.id = id});
    }
  }
  const double before = believed.translation().norm();
  for (NodeId id = 0; id < kThere; ++id) {
    PoseEdge loop = test::edge(id, kBack - id, Eigen::Isometry3d::Identity());
    loop.information.diagonal() << 1e3, 1e3, 1e3, 1e5, 1e5, 1e5;
    graph.add_edge(loop);
  }
  const LoopOptimum found = optimize_with_loops(graph);
  EXPECT_GT(found.odometry_scale, 10.0);
  EXPECT_LT(found.poses.back().translation().norm(), 0.1 * before);
  for (std::size_t i = static_cast<std::size_t>(kBack); i < graph.edges().size(); ++i) {
    EXPECT_LT(found.report.edges[i]->chi2, kLoopReview) << i;
  }
}

TEST(OptimizeWithLoops, OneEdgeThatIsFarOffDoesNotChangeTheScale) {
  Square square(Eigen::Isometry3d::Identity());
  const PoseEdge off = [&] {
    PoseEdge edge = square.graph.edges()[20];
    edge.T_from_to.translation().y() += 0.3;
    return edge;
  }();
  PoseGraph graph;
  for (const PoseNode& node : square.graph.nodes()) {
    graph.add_node(node);
  }
  for (const PoseEdge& edge : square.graph.edges()) {
    graph.add_edge(edge.from == off.from ? off : edge);
  }
  square.graph = graph;
  square.add_loops_at_the_end();
  const LoopOptimum found = optimize_with_loops(square.graph);
  EXPECT_EQ(found.odometry_scale, 1.0);
  EXPECT_FALSE(found.all_drift);
}

// Round a circle of 200 m. Each metre climbs by 0.1 m and turns by 0.1 degrees too far, a hundred
// and six standard deviations; four edges are known three times as badly, and the kernel would have
// these jump by metres.
TEST(OptimizeWithLoops, WhatAllEdgesDriftByIsNoJumpOfAFew) {
  constexpr NodeId kRound = 200;
  constexpr double kTurn = 2.0 * std::numbers::pi / static_cast<double>(kRound);
  const Eigen::Isometry3d drift =
      Eigen::Translation3d(0.0, 0.0, 0.1) * Eigen::AngleAxisd(0.0017, Eigen::Vector3d::UnitZ());
  PoseGraph graph;
  std::vector<Eigen::Isometry3d> truth;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d believed = pose;
  for (NodeId id = 0; id < kRound + 4; ++id) {
    truth.push_back(pose);
    graph.add_node({.id = id, .T_map_node = believed});
    if (id > 0) {
      PoseEdge edge = test::edge(id - 1, id, test::step(1.0, kTurn) * drift);
      edge.information.diagonal() << 1e6, 1e6, 1e6, 1.4e7, 1.4e7, 1.4e7;
      edge.information *= id % 50 == 25 ? 0.1 : 1.0;
      graph.add_edge(edge);
    }
    pose = pose * test::step(1.0, kTurn);
    believed = believed * test::step(1.0, kTurn) * drift;
  }
  for (NodeId id = 0; id < 4; ++id) {
    PoseEdge loop = test::edge(id, id + kRound, Eigen::Isometry3d::Identity());
    loop.information.diagonal() << 1e3, 1e3, 1e3, 1e5, 1e5, 1e5;
    graph.add_edge(loop);
  }
  const LoopOptimum found = optimize_with_loops(graph);
  EXPECT_TRUE(found.all_drift);
  EXPECT_GT(found.odometry_scale, 10.0);
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    EXPECT_LT(found.report.edges[i]->chi2,
              graph.edges()[i].kind == EdgeKind::loop ? kLoopReview : 100.0);
  }
  double worst = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    worst = std::max(worst, (found.poses[i].translation() - truth[i].translation()).norm());
  }
  EXPECT_LT(worst, 0.2 * (believed.translation() - pose.translation()).norm());
}

// Climbing by 0.1 m a metre along a circle of 200 m that is closed at one place. Verticals of 20
// mrad would have all of the way lean by degrees, which takes less than edges that are off by that
// much.
TEST(OptimizeWithLoops, AClimbThatAllEdgesHaveDoesNotHaveTheWayLean) {
  constexpr NodeId kRound = 200;
  constexpr double kTurn = 2.0 * std::numbers::pi / static_cast<double>(kRound);
  const Eigen::Isometry3d drift(Eigen::Translation3d(0.0, 0.0, 0.1));
  PoseGraph graph;
  Eigen::Isometry3d believed = Eigen::Isometry3d::Identity();
  for (NodeId id = 0; id < kRound + 4; ++id) {
    graph.add_node({.id = id, .T_map_node = believed});
    graph.add_level({.node = id, .information = 2500.0});
    if (id > 0) {
      PoseEdge edge = test::edge(id - 1, id, test::step(1.0, kTurn) * drift);
      edge.information.diagonal() << 1e5, 1e5, 1e5, 2e6, 2e6, 2e6;
      graph.add_edge(edge);
    }
    believed = believed * test::step(1.0, kTurn) * drift;
  }
  for (NodeId id = 0; id < 4; ++id) {
    PoseEdge loop = test::edge(0, id + kRound, test::step(0.0));
    loop.T_from_to = Eigen::Isometry3d::Identity();
    for (NodeId i = 0; i < id; ++i) {
      loop.T_from_to = loop.T_from_to * test::step(1.0, kTurn);
    }
    loop.information.diagonal() << 1e3, 1e3, 1e3, 1e5, 1e5, 1e5;
    graph.add_edge(loop);
  }
  const LoopOptimum found = optimize_with_loops(graph);
  EXPECT_TRUE(found.all_drift);
  double most = 0.0;
  for (const Eigen::Isometry3d& pose : found.poses) {
    most = std::max(most, std::acos(std::min(1.0, (found.T_world_map * pose).linear()(2, 2))));
  }
  EXPECT_LT(most, 0.035);
}

}  // namespace
}  // namespace adit
