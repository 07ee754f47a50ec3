// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Loops that tie parts of a map, between which the odometry has lost its track.
#include <algorithm>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/loops/join_review.hpp"
#include "adit/tests/mapping/graph_support.hpp"

namespace adit {
namespace {

using test::edge;
using test::step;

constexpr NodeId kCorridor = 40;  // keyframes, 1 m apart
constexpr NodeId kLost = 60;      // the keyframe with which the odometry starts anew

/// Along a corridor that is half a ring, along the other half to where it began, and along it
/// again: on the same floor or, `above`, on one like it, 3.4 m higher. On the other half the
/// odometry loses its track and begins anew somewhere else.
struct PartedWalk {
  std::vector<Eigen::Isometry3d> truth{};
  PoseGraph graph{};
  TrackingGap gap{};
};

PartedWalk parted_walk(bool above, NodeId lost = kLost) {
  PartedWalk walk{.gap = tracking_gap(lost, 1.0, 1.3)};
  const Eigen::Isometry3d begun_anew = step(-30.0, 2.0);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (NodeId id = 0; id < 3 * kCorridor; ++id) {
    walk.truth.push_back(pose);
    const bool is_lost = id >= lost;
    walk.graph.add_node(
        {.id = id,
         .T_map_node =
             is_lost ? begun_anew * walk.truth[static_cast<std::size_t>(lost)].inverse() * pose
                     : pose});
    if (id > 0 && id != lost) {
      const Eigen::Isometry3d way = walk.truth[static_cast<std::size_t>(id) - 1].inverse() * pose;
      PoseEdge tied = edge(id - 1, id, way);
      tied.information.diagonal() << 1e4, 1e4, 1e4, 1e6, 1e6, 1e6;
      walk.graph.add_edge(tied);
    }
    const double turn = std::numbers::pi / static_cast<double>(kCorridor);
    Eigen::Isometry3d on = step(1.0, turn);
    on.translation().z() =
        above && id >= kCorridor && id < 2 * kCorridor ? 3.4 / static_cast<double>(kCorridor) : 0.0;
    pose = pose * on;
  }
  return walk;
}

/// What alignments find along the corridor when it is passed again.
std::vector<LoopHypothesis> found_again(const PartedWalk& walk, NodeId first, NodeId last,
                                        double down) {
  std::vector<LoopHypothesis> loops;
  for (NodeId from = first; from <= last; ++from) {
    const NodeId to = 2 * kCorridor + from;
    Eigen::Isometry3d shift = Eigen::Isometry3d::Identity();
    shift.translation().z() = -down;
    loops.push_back({.id = to,
                     .from = from,
                     .to = to,
                     .T_from_to = walk.truth[static_cast<std::size_t>(from)].inverse() * shift *
                                  walk.truth[static_cast<std::size_t>(to)],
                     .covariance = test::diagonal_covariance(0.03, 0.003),
                     .strong = true,
                     .source = LoopSource::appearance});
  }
  return loops;
}

std::vector<LoopVote> voted(const PartedWalk& walk, const std::vector<LoopHypothesis>& loops,
                            bool gap_known = true) {
  const std::vector<TrackingGap> gaps(gap_known ? 1 : 0, walk.gap);
  return vote(walk.graph, loops, {.gaps = gaps}, true, {});
}

std::size_t joined(const PartedWalk& walk, const std::vector<LoopHypothesis>& loops,
                   bool gap_known = true) {
  const std::vector<LoopVote> votes = voted(walk, loops, gap_known);
  return static_cast<std::size_t>(std::ranges::count_if(votes, &LoopVote::accepted));
}

TEST(LoopsBetweenParts, TieThemWhereTheGapAllowsIt) {
  const PartedWalk walk = parted_walk(false);
  EXPECT_EQ(joined(walk, found_again(walk, 5, 18, 0.0)), 14U);
}

TEST(LoopsBetweenParts, HaveToBeSeenAlongAWay) {
  const PartedWalk walk = parted_walk(false);
  EXPECT_EQ(joined(walk, found_again(walk, 5, 9, 0.0)), 0U) << "five keyframes, 4 m";
  EXPECT_EQ(voted(walk, found_again(walk, 5, 9, 0.0)).front().objection, LoopObjection::voters);
  std::vector<LoopHypothesis> few = found_again(walk, 5, 18, 0.0);
  few.erase(few.begin() + 2, few.end() - 1);
  EXPECT_EQ(joined(walk, few), 0U) << "three keyframes";
}

TEST(LoopsBetweenParts, AFloorLikeTheOneBelowIsFartherThanTheGap) {
  const PartedWalk walk = parted_walk(true);
  const std::vector<LoopHypothesis> twins = found_again(walk, 5, 18, 3.4);
  EXPECT_EQ(joined(walk, twins, false), 14U) << "who knows nothing of the gap is taken in";
  EXPECT_EQ(joined(walk, twins), 0U);
  for (const LoopVote& one : voted(walk, twins)) {
    EXPECT_EQ(one.objection, LoopObjection::odometry);
    EXPECT_GT(one.odometry_chi2, 11.34);
  }
}

// Without an inertial sensor an odometry may know its height so badly that its covariances bear out
// a whole floor.
TEST(LoopsBetweenParts, AFloorIsAnotherHoweverLittleTheHeightIsKnown) {
  const auto height_unknown = [](PartedWalk walk) {
    walk.graph = walk.graph.with_information([](const PoseEdge& edge) {
      Matrix6d information = edge.information;
      information(2, 2) = 25.0;  // 0.2 m a metre
      return information;
    });
    return walk;
  };
  const PartedWalk below = height_unknown(parted_walk(false));
  EXPECT_EQ(joined(below, found_again(below, 5, 18, 0.0)), 14U);
  EXPECT_EQ(joined(below, found_again(below, 5, 18, 0.9)), 14U) << "as much is drift";
  const PartedWalk above = height_unknown(parted_walk(true));
  EXPECT_EQ(joined(above, found_again(above, 5, 18, 3.4)), 0U);
}

// The odometry starts anew before the stairs and after them: what lies between tells the floors.
TEST(LoopsBetweenParts, WhatThePartBetweenHasClimbedCounts) {
  const auto joined_over_two_gaps = [](bool above) {
    PartedWalk walk = parted_walk(above, kCorridor);
    walk.graph.set_status(static_cast<std::size_t>(2 * kCorridor) - 2, EdgeStatus::revoked);
    const std::vector<TrackingGap> gaps = {walk.gap, tracking_gap(2 * kCorridor, 1.0, 1.3)};
    const std::vector<LoopVote> votes =
        vote(walk.graph, found_again(walk, 5, 18, above ? 3.4 : 0.0), {.gaps = gaps}, true, {});
    return std::ranges::count_if(votes, &LoopVote::accepted);
  };
  EXPECT_EQ(joined_over_two_gaps(false), 14);
  EXPECT_EQ(joined_over_two_gaps(true), 0);
}

TEST(LoopsBetweenParts, APlaceThatCouldNotBeReachedMeanwhileIsAnother) {
  const PartedWalk walk = parted_walk(false);
  std::vector<LoopHypothesis> elsewhere = found_again(walk, 5, 18, 0.0);
  for (LoopHypothesis& one : elsewhere) {
    one.from += 12;  // along the same corridor, which looks alike
  }
  EXPECT_EQ(joined(walk, elsewhere, false), 14U);
  EXPECT_EQ(joined(walk, elsewhere), 0U);
}

TEST(LoopsBetweenParts, AJoinIsDoubtedWhereLaterLoopsAgreeOnAnother) {
  PartedWalk walk = parted_walk(false);
  std::vector<LoopHypothesis> wrong = found_again(walk, 5, 18, 0.0);
  for (LoopHypothesis& one : wrong) {
    one.from += 12;
    walk.graph.add_edge(edge(one.from, one.to, one.T_from_to));
  }
  const std::vector<LoopHypothesis> right = found_again(walk, 19, 32, 0.0);
  const auto agreeing = [&](const std::vector<LoopHypothesis>& refused,
                            const std::vector<LoopHypothesis>& accepted) {
    return agreeing_on_another_join(walk.graph, walk.gap, refused, accepted,
                                    std::span(&walk.gap, 1), {});
  };
  EXPECT_EQ(agreeing(right, wrong), 14U);
  EXPECT_EQ(agreeing(found_again(walk, 19, 22, 0.0), wrong), 0U) << "4 m of way";
  EXPECT_EQ(agreeing(right, right), 0U) << "as many go on with the join";
  EXPECT_EQ(agreeing(found_again(walk, 19, 32, 3.4), wrong), 0U) << "farther than the gap";
  EXPECT_TRUE(crosses(walk.graph, walk.gap, 0, kLost));
  EXPECT_FALSE(crosses(walk.graph, walk.gap, kLost, kLost + 1));
}

TEST(TrackingGaps, AddUpWithThePartsBetweenThem) {
  // Parts 0-9, 10-19 (9 m long) and 20-29.
  PoseGraph graph = test::line(30);
  graph.set_status(9, EdgeStatus::revoked);
  graph.set_status(19, EdgeStatus::revoked);
  const GraphComponents parts = connected_components(graph);
  const std::vector<TrackingGap> gaps = {{.after = 10, .reach = 2.0, .climb = 0.5},
                                         {.after = 20, .reach = 3.0, .climb = 0.7}};
  const auto crossings = gap_crossings(graph, parts.component_of, gaps, 0, 2);
  ASSERT_EQ(crossings.size(), 1U);
  EXPECT_EQ(crossings[0].last, 9);
  EXPECT_EQ(crossings[0].first, 20);
  EXPECT_NEAR(crossings[0].reach, 14.0, 1e-12);
  EXPECT_NEAR(crossings[0].climb, 1.2, 1e-12);
  EXPECT_NEAR(crossings[0].between, 9.0, 1e-12);
  EXPECT_NEAR(crossings[0].rise, 0.0, 1e-12);
  EXPECT_EQ(gap_crossings(graph, parts.component_of, gaps, 0, 1).size(), 1U);
  EXPECT_TRUE(gap_crossings(graph, parts.component_of, std::span(gaps).first(1), 0, 2).empty())
      << "one of them is not known";
  // The first and the last are tied: the second lies between two crossings.
  graph.add_edge(edge(0, 29, step(29.0)));
  const GraphComponents tied = connected_components(graph);
  EXPECT_EQ(gap_crossings(graph, tied.component_of, gaps, 0, 1).size(), 2U);
}

TEST(TrackingGaps, GrowWithTimeAndSpeed) {
  const TrackingGap walked = tracking_gap(1, 1.0, 1.3);
  EXPECT_LT(walked.climb, 1.2) << "no floor";
  EXPECT_GT(walked.reach, 2.0);
  EXPECT_GT(tracking_gap(1, 10.0, 1.3).climb, 3.4);
  EXPECT_GT(tracking_gap(1, 1.0, 15.0).reach, 20.0);
}

}  // namespace
}  // namespace adit
