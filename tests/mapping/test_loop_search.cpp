// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/loops/loop_search.hpp"

#include <gtest/gtest.h>

#include "adit/tests/mapping/graph_support.hpp"

namespace adit {
namespace {

using test::edge;
using test::step;

Eigen::Isometry3d at(double x, double y, double z = 0.0) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(x, y, z);
  return pose;
}

/// A chain along these poses, each edge known to `information` in every direction.
PoseGraph chain(const std::vector<Eigen::Isometry3d>& poses, double information) {
  PoseGraph graph;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const auto id = static_cast<NodeId>(i);
    graph.add_node({.id = id, .T_map_node = poses[i]});
    if (i > 0) {
      graph.add_edge(edge(id - 1, id, poses[i - 1].inverse() * poses[i], information));
    }
  }
  return graph;
}

/// 20 m ahead, `aside` to the left, and back to the start beside where it came from.
std::vector<Eigen::Isometry3d> there_and_back(double aside, double up = 0.0) {
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i <= 10; ++i) {
    poses.push_back(at(2.0 * i, 0.0));
  }
  for (int i = 10; i >= 0; --i) {
    poses.push_back(at(2.0 * i, aside, up));
  }
  return poses;
}

std::vector<LoopPlace> found(const PoseGraph& graph, const LoopSearchSettings& settings = {},
                             double reach = 5.0) {
  const std::vector<double> reaches(graph.nodes().size(), reach);
  const NodeId newest = graph.nodes().back().id;
  return find_loop_places(graph, newest, relative_places(graph, newest), reaches, settings);
}

TEST(LoopSearch, FindsTheNearestPlaceOfAStretchThatTheGateLetsThrough) {
  const PoseGraph graph = chain(there_and_back(1.0), 1e4);
  const std::vector<LoopPlace> places = found(graph);
  ASSERT_EQ(places.size(), 1U) << "one for each stretch";
  EXPECT_EQ(places[0].node, 0);
  EXPECT_NEAR(places[0].distance, 1.0, 1e-12);
  EXPECT_EQ(places[0].score, 0.0) << "within the dead zone";
  EXPECT_NEAR(places[0].path, 41.0, 1e-12);
  EXPECT_TRUE(places[0].T_node_newest.isApprox(at(0.0, 1.0)));
}

TEST(LoopSearch, WhatDriftCannotHaveMadeIsLeftOut) {
  // 12 m aside: 10 m beyond the dead zone.
  EXPECT_TRUE(found(chain(there_and_back(12.0), 1e6)).empty()) << "known to the centimetre";
  const std::vector<LoopPlace> drifted = found(chain(there_and_back(12.0), 20.0));
  ASSERT_FALSE(drifted.empty()) << "sigmas of 0.2 m and 0.2 rad an edge";
  EXPECT_GT(drifted[0].score, 0.0);
  EXPECT_LT(drifted[0].score, 7.815);
  EXPECT_TRUE(found(chain(there_and_back(12.0), 20.0), {.max_distance = 10.0}).empty());
}

TEST(LoopSearch, SubmapsThatReachFarHaveALargerDeadZone) {
  const PoseGraph graph = chain(there_and_back(6.0), 1e6);
  EXPECT_TRUE(found(graph, {}, 5.0).empty());
  EXPECT_EQ(found(graph, {}, 20.0).size(), 1U) << "0.3 of 20 m";
}

TEST(LoopSearch, WhatIsNearAlongTheEdgesIsNoLoop) {
  const PoseGraph graph = test::line(9);
  EXPECT_TRUE(found(graph, {.gate = 1e9}).empty());
  EXPECT_EQ(found(graph, {.gate = 1e9, .min_path = 5.0, .detour = 0.0}).size(), 1U);
  PoseGraph tied = chain(there_and_back(1.0), 1e4);
  tied.add_edge(edge(1, 20, at(0.0, 1.0), 1e4));
  EXPECT_TRUE(found(tied).empty()) << "a loop has closed it";
}

TEST(LoopSearch, StraightOnIsNoLoopHoweverFar) {
  const PoseGraph street = test::line(40);
  EXPECT_TRUE(found(street, {.gate = 1e9}).empty()) << "39 m of way, 39 m apart";
  EXPECT_FALSE(found(street, {.gate = 1e9, .detour = 0.0}).empty());
  // Round a corner and on: as far along the edges as before, but no place is seen again.
  std::vector<Eigen::Isometry3d> corner;
  for (int i = 0; i < 8; ++i) {
    corner.push_back(at(2.0 * i, 0.0));
  }
  for (int i = 1; i < 8; ++i) {
    corner.push_back(at(14.0, 2.0 * i));
  }
  EXPECT_TRUE(found(chain(corner, 1e2), {.gate = 1e9}).empty());
  EXPECT_FALSE(found(chain(there_and_back(6.0), 1e6), {}, 20.0).empty()) << "on the other lane";
}

TEST(LoopSearch, OnePlaceAStretchAndTheNearestOfThemFirst) {
  // Rounds beside each other; each pass is a stretch of its own.
  std::vector<Eigen::Isometry3d> poses;
  for (int round = 0; round < 8; ++round) {
    for (int i = 0; i < 12; ++i) {
      const double angle = 2.0 * 3.14159265358979 * i / 12.0;
      poses.push_back(at(20.0 * std::cos(angle) + 0.2 * round, 20.0 * std::sin(angle)));
    }
  }
  const PoseGraph graph = chain(poses, 1e6);
  const std::vector<LoopPlace> places = found(graph);
  ASSERT_EQ(places.size(), 5U) << "of seven";
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_EQ(places[i].node, 12 * (7 - static_cast<NodeId>(i)) - 1);
  }
}

TEST(LoopSearch, PartsOfAMapThatNothingTiesAreNotFound) {
  PoseGraph graph = chain(there_and_back(1.0), 1e4);
  graph.set_status(10, EdgeStatus::revoked);
  EXPECT_TRUE(found(graph).empty());
}

}  // namespace
}  // namespace adit
