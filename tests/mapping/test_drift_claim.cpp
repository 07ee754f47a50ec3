// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/graph/drift_claim.hpp"
#include "adit/tests/mapping/graph_support.hpp"

namespace adit {
namespace {

using test::edge;
using test::step;
using test::up;

TEST(DriftClaim, LimitsGrowWithThePath) {
  EXPECT_TRUE(is_possible_drift(up(1.4), 10.0));
  EXPECT_FALSE(is_possible_drift(up(3.4), 10.0));
  EXPECT_TRUE(is_possible_drift(up(3.4), 30.0));
  EXPECT_FALSE(is_possible_drift(step(10.0), 100.0));
  EXPECT_TRUE(is_possible_drift(step(10.0), 300.0));
  EXPECT_FALSE(is_possible_drift(up(0.0, 0.5), 100.0));
  EXPECT_TRUE(is_possible_drift(up(0.0, 0.3), 100.0));
  const Eigen::Isometry3d tilted(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()));
  EXPECT_TRUE(is_possible_drift(tilted, 1.0)) << "an optimisation may have put it there";
  EXPECT_TRUE(is_possible_drift(step(30.0, 0.3), 100.0)) << "a turn moves what comes after aside";
}

// Along a line and along it again, tied over the first 8 m of it and drifting upwards after that.
TEST(DriftClaim, EndsWhereEarlierLoopsTieTheStretches) {
  PoseGraph graph = test::line(21);
  const NodeId again = 100;
  for (NodeId i = 0; i <= 20; ++i) {
    const auto x = static_cast<double>(i);
    const Eigen::Isometry3d pose = step(x) * up(0.14 * std::max(0.0, x - 8.0));
    graph.add_node({.id = again + i, .T_map_node = pose});
    const NodeId before = i == 0 ? 20 : again + i - 1;
    graph.add_edge(
        edge(before, again + i, graph.nodes()[graph.index_of(before)].T_map_node.inverse() * pose));
  }
  EXPECT_TRUE(drift_explains(graph, 8, again + 8, up(0.0)));
  EXPECT_FALSE(drift_explains(graph, 8, again + 8, up(-12.0)));
  for (NodeId i = 0; i <= 8; ++i) {
    graph.add_edge(edge(i, again + i, up(0.0)));
  }
  EXPECT_TRUE(drift_explains(graph, 12, again + 12, up(0.0))) << "0.56 m of drift since";
  EXPECT_FALSE(drift_explains(graph, 9, again + 9, up(-2.0))) << "tied a metre before";
}

// The way between the stretches is 2 m long where they part, and 2 m longer with each keyframe.
TEST(DriftClaim, HoldsForEachPairOfALongStretch) {
  constexpr NodeId kLength = 300;
  PoseGraph graph = test::line(kLength);
  for (NodeId i = 0; i < kLength; ++i) {
    const NodeId id = 1000 + i;
    graph.add_node({.id = id, .T_map_node = step(static_cast<double>(i))});
    graph.add_edge(i == 0 ? edge(0, id, up(0.0)) : edge(id - 1, id, step(1.0)));
  }
  for (const NodeId i : {2, 40, 299}) {
    EXPECT_TRUE(drift_explains(graph, i, 1000 + i, up(-1.09))) << "0.5 m and 15 % of 4 m";
    EXPECT_FALSE(drift_explains(graph, i, 1000 + i, up(-1.11))) << i;
  }
}

// Loops have closed a round with much drift, and the optimum has had one edge take what all of them
// should: what is claimed a metre behind it is what was measured in that metre.
TEST(DriftClaim, IsOfWhatTheWayHasMeasuredWhereAnOptimumHasBentIt) {
  PoseGraph graph = test::line(21);
  const NodeId again = 100;
  for (NodeId i = 0; i <= 10; ++i) {
    const auto x = static_cast<double>(i);
    graph.add_node({.id = again + i, .T_map_node = step(x) * up(i > 4 ? 5.0 : 0.0)});
    graph.add_edge(i == 0 ? edge(20, again, step(-20.0)) : edge(again + i - 1, again + i, step(1)));
  }
  for (NodeId i = 0; i <= 3; ++i) {
    graph.add_edge(edge(i, again + i, up(0.0)));
  }
  EXPECT_TRUE(drift_explains(graph, 5, again + 5, up(0.0)));
  EXPECT_FALSE(drift_explains(graph, 5, again + 5, up(5.0))) << "where the graph has it";
}

TEST(ShownClimb, TellsDriftFromAFloorLikeTheOneBelow) {
  const auto claim = [](double climb, double way) {
    return ClaimedClimb{.climb = climb, .length = way, .way = way};
  };
  ShownClimb shown;
  EXPECT_TRUE(shown.allows(claim(3.4, 30.0))) << "nothing has been shown yet";
  shown.add(claim(1.9, 9.0));
  shown.add(claim(1.8, 40.0));
  EXPECT_TRUE(shown.allows(claim(3.4, 30.0))) << "little has";
  shown.add(claim(1.8, 90.0));
  EXPECT_FALSE(shown.allows(claim(3.4, 30.0)));
  EXPECT_FALSE(shown.allows(claim(-2.2, 45.0)));
  EXPECT_TRUE(shown.allows(claim(1.1, 45.0)));
  EXPECT_TRUE(shown.allows(claim(0.4, 2.0)));
}

// Out and back, and up a floor: each loop on the way back leaves two metres that none has
// corrected.
TEST(ShownClimb, IsOfTheWholeWayThatNestedLoopsTie) {
  constexpr NodeId kOut = 40;
  PoseGraph graph = test::line(1);
  for (NodeId i = 1; i <= 2 * kOut; ++i) {
    const double at = static_cast<double>(i <= kOut ? i : 2 * kOut - i);
    graph.add_node({.id = i, .T_map_node = step(at)});
    graph.add_edge(edge(i - 1, i, step(i <= kOut ? 1.0 : -1.0)));
  }
  ShownClimb shown;
  for (NodeId i = kOut + 7; i <= 2 * kOut; ++i) {
    const NodeId earlier = 2 * kOut - i;
    const auto climb = climb_of_odometry(graph, earlier, i, up(-0.001));
    ASSERT_TRUE(climb);
    EXPECT_NEAR(climb->length, static_cast<double>(i - earlier), 1e-12);
    EXPECT_NEAR(climb->climb, 0.001, 1e-12);
    shown.add(*climb);
    PoseEdge loop = edge(earlier, i, up(-0.001));
    loop.kind = EdgeKind::loop;
    graph.add_edge(loop);
  }
  const auto floor = [](double way) { return ClaimedClimb{3.4, way, way}; };
  EXPECT_FALSE(shown.allows(floor(32.0))) << "within 15 % of the way";
  graph.set_status(3, EdgeStatus::revoked);
  EXPECT_FALSE(climb_of_odometry(graph, 0, 2 * kOut, up(0.0))) << "nothing ties them";
  EXPECT_TRUE(climb_of_odometry(graph, 4, 2 * kOut, up(0.0)));
}

TEST(ShownClimb, IsSteadyWhereAllClaimsClimbAlike) {
  const auto claim = [](double climb, double way) { return ClaimedClimb{climb, way, way}; };
  ShownClimb steady;
  EXPECT_FALSE(steady.is_steady());
  for (const double way : {20.0, 40.0, 60.0}) {
    steady.add(claim(0.1 * way + 0.05, way));
  }
  EXPECT_TRUE(steady.is_steady());
  ShownClimb level;
  ShownClimb once;  // 2 m somewhere, whatever the way
  for (const double way : {20.0, 40.0, 60.0}) {
    level.add(claim(0.001 * way, way));
    once.add(claim(2.0, way));
  }
  EXPECT_FALSE(level.is_steady());
  EXPECT_FALSE(once.is_steady());
}

TEST(DriftClaim, GrowsWithItsWayWhereItIsDrift) {
  const auto claims = [](double staying, double growing) {
    std::vector<ClaimedDrift> made;
    for (const double way : {12.0, 14.0, 16.0, 18.0}) {
      const double off = staying + growing * way + (way == 14.0 ? 0.01 : -0.01);
      made.push_back({.off = off * Eigen::Vector3d(0.6, 0.0, 0.8), .way = way});
    }
    return made;
  };
  EXPECT_TRUE(grows_with_way(claims(0.0, 0.1)));
  EXPECT_TRUE(grows_with_way(claims(0.0, -0.1)));
  EXPECT_FALSE(grows_with_way(claims(3.4, 0.0)));
  EXPECT_FALSE(grows_with_way(claims(3.4, 0.1)));
  EXPECT_FALSE(grows_with_way(claims(-1.0, 0.1)));
  EXPECT_FALSE(grows_with_way({}));
  std::vector<ClaimedDrift> again = claims(0.0, 0.1);
  for (ClaimedDrift& claim : again) {
    claim.way = 60.0;  // the same way once more
  }
  EXPECT_FALSE(grows_with_way(again));
  again.front().way = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(grows_with_way(again));
}

TEST(ClaimedClimb, CountsTheWayThatNoLoopHasCorrected) {
  PoseGraph graph = test::line(11);
  const ClaimedClimb whole = claimed_climb(graph, 0, 10, step(10.0) * up(-1.0));
  EXPECT_NEAR(whole.climb, 1.0, 1e-12);
  EXPECT_NEAR(whole.length, 10.0, 1e-12);
  EXPECT_NEAR(whole.way, 10.0, 1e-12);
  graph.add_edge(edge(2, 6, step(4.0)));
  EXPECT_NEAR(claimed_climb(graph, 0, 10, step(10.0)).way, 6.0, 1e-12);
  EXPECT_EQ(within_loops(graph), (std::vector<bool>{false, false, true, true, true, true, false,
                                                    false, false, false, false}));
}

}  // namespace
}  // namespace adit
