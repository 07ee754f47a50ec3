// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Loops that the odometry does not bear out, such as appearance finds: how far they may contradict
// it, and that twins are not taken for a place seen again.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/graph/implied_drift.hpp"
#include "adit/slam/loops/loop_voting.hpp"
#include "adit/tests/mapping/graph_support.hpp"

namespace adit {
namespace {

using test::edge;
using test::step;
using test::up;

/// Poses as they are, and a graph as a drifting odometry has them.
struct Walk {
  std::vector<Eigen::Isometry3d> truth{};
  PoseGraph graph{};
  Eigen::Isometry3d believed = Eigen::Isometry3d::Identity();

  void start() {
    truth.push_back(Eigen::Isometry3d::Identity());
    graph.add_node({.id = 0});
  }
  /// One keyframe on; the edge is known to a millimetre, whatever the drift.
  void go(const Eigen::Isometry3d& way, const Eigen::Isometry3d& drift) {
    const auto id = static_cast<NodeId>(truth.size());
    truth.push_back(truth.back() * way);
    believed = believed * way * drift;
    graph.add_node({.id = id, .T_map_node = believed});
    PoseEdge tied = edge(id - 1, id, way * drift);
    tied.information.diagonal() << 1e6, 1e6, 1e6, 1e8, 1e8, 1e8;
    graph.add_edge(tied);
  }
};

/// What an alignment finds between two keyframes whose places lie a shift of the world apart.
LoopHypothesis loop(const Walk& walk, NodeId from, NodeId to,
                    const Eigen::Isometry3d& shift = Eigen::Isometry3d::Identity()) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(0.03), Eigen::Vector3d::Constant(0.003);
  return {.id = 1000 * to + from,
          .from = from,
          .to = to,
          .T_from_to = walk.truth[static_cast<std::size_t>(from)].inverse() * shift *
                       walk.truth[static_cast<std::size_t>(to)],
          .covariance = sigma.cwiseAbs2().asDiagonal(),
          .strong = true,
          .source = LoopSource::appearance};
}

std::size_t accepted(const Walk& walk, const std::vector<LoopHypothesis>& loops,
                     const EarlierLoops& before = {}) {
  std::size_t count = 0;
  for (const LoopVote& one : vote(walk.graph, loops, before, true, {})) {
    count += one.accepted ? 1U : 0U;
  }
  return count;
}

constexpr NodeId kRoundOfWalk = 60;

/// Round a circle of 60 m and on, 1 m a keyframe, with 0.02 degrees of yaw and 2 % of climb a metre
/// that nobody knows of, times `share`.
Walk drifting_round(bool reverse, double share = 1.0) {
  Walk walk;
  walk.start();
  const Eigen::Isometry3d drift = up(0.02 * share, 0.02 * share * std::numbers::pi / 180.0);
  const auto on = [&](double turn) { walk.go(step(1.0, turn), drift); };
  for (NodeId i = 0; i < kRoundOfWalk + 10; ++i) {
    on(2.0 * std::numbers::pi / kRoundOfWalk);
  }
  if (reverse) {
    for (NodeId i = 0; i < 30; ++i) {  // backwards along the same circle
      walk.go(step(1.0, 2.0 * std::numbers::pi / kRoundOfWalk).inverse(), drift);
    }
  }
  return walk;
}

TEST(LoopsByAppearance, ComeInWhereTheOdometryDriftedUnawares) {
  const Walk walk = drifting_round(false);
  std::vector<LoopHypothesis> loops;
  for (NodeId i = 1; i <= 4; ++i) {
    loops.push_back(loop(walk, i, kRoundOfWalk + i));
  }
  EXPECT_GT(odometry_disagreement(walk.graph, loops.front()), 1e3);
  EXPECT_EQ(accepted(walk, loops), 4U);
  for (LoopHypothesis& one : loops) {
    one.source = LoopSource::position;
  }
  EXPECT_EQ(accepted(walk, loops), 4U) << "however they were found";
  const Walk wild = drifting_round(false, 5.0);
  for (NodeId i = 1; i <= 4; ++i) {
    loops[static_cast<std::size_t>(i - 1)] = loop(wild, i, kRoundOfWalk + i);
  }
  EXPECT_EQ(accepted(wild, loops), 0U) << "no odometry climbs by 10 %";
}

TEST(LoopsByPosition, ThatAreBeyondTheGateComeIn) {
  const Walk walk = drifting_round(false, 0.2);
  std::vector<LoopHypothesis> loops;
  for (NodeId i = 1; i <= 4; ++i) {
    loops.push_back(loop(walk, i, kRoundOfWalk + i));
    loops.back().source = LoopSource::position;
  }
  EXPECT_GT(odometry_disagreement(walk.graph, loops.front()), 16.81);
  EXPECT_LT(odometry_disagreement(walk.graph, loops.front()), 100.0);
  EXPECT_EQ(accepted(walk, loops), 4U);
}

TEST(LoopsByAppearance, ComeInOnTheWayBackToo) {
  const Walk walk = drifting_round(true);
  std::vector<LoopHypothesis> loops;
  for (NodeId i = 0; i < 4; ++i) {
    loops.push_back(loop(walk, kRoundOfWalk + 10 - 20 - i, kRoundOfWalk + 10 + 20 + i));
  }
  EXPECT_EQ(accepted(walk, loops), 4U) << "drift adds up along both stretches";
}

TEST(LoopsByPosition, ThatAreFarOffComeInWhereDriftExplainsThem) {
  const Walk walk = drifting_round(true);
  std::vector<LoopHypothesis> loops;
  for (NodeId i = 0; i < 4; ++i) {
    loops.push_back(loop(walk, kRoundOfWalk + 3 - i, kRoundOfWalk + 10 + 7 + i));
    loops.back().source = LoopSource::position;
  }
  EXPECT_GT(odometry_disagreement(walk.graph, loops.front()), 50.0);
  EXPECT_EQ(accepted(walk, loops), 4U);
  loops.pop_back();
  EXPECT_EQ(accepted(walk, loops), 0U) << "three are too few";
}

TEST(LoopsByPosition, ThatAreFarOffAndStaySoAreAnotherPlace) {
  // A corridor's end, out and back; 1.4 m beside it one like it.
  Walk walk;
  walk.start();
  for (int i = 0; i < 20; ++i) {
    walk.go(i < 10 ? step(1.0) : step(1.0).inverse(), Eigen::Isometry3d::Identity());
  }
  Eigen::Isometry3d beside = Eigen::Isometry3d::Identity();
  beside.translation().z() = 1.4;
  std::vector<LoopHypothesis> loops;
  for (NodeId i = 0; i < 4; ++i) {
    loops.push_back(loop(walk, 6 - i, 14 + i, beside));
    loops.back().source = LoopSource::position;
  }
  EXPECT_GT(odometry_disagreement(walk.graph, loops.front()), 100.0);
  for (const LoopVote& one : vote(walk.graph, loops, {}, true, {})) {
    EXPECT_FALSE(one.accepted);
    EXPECT_EQ(one.objection, LoopObjection::odometry);
  }
}

TEST(LoopsByAppearance, FourKeyframesHaveToAgreeAndNoneComesAlone) {
  const Walk walk = drifting_round(false);
  std::vector<LoopHypothesis> loops;
  for (NodeId i = 1; i <= 3; ++i) {
    loops.push_back(loop(walk, i, kRoundOfWalk + i));
  }
  EXPECT_EQ(accepted(walk, loops), 0U);
  loops.push_back(loop(walk, 4, kRoundOfWalk + 4, up(3.0)));
  EXPECT_EQ(accepted(walk, loops), 0U) << "the fourth says something else";
}

TEST(LoopsByAppearance, TwoPlacesThatAreBothBorneOutGiveNothing) {
  const Walk walk = drifting_round(false);
  std::vector<LoopHypothesis> loops;
  for (NodeId i = 1; i <= 4; ++i) {
    loops.push_back(loop(walk, i, kRoundOfWalk + i));
    loops.push_back(loop(walk, i + 1, kRoundOfWalk + i));
    loops.back().T_from_to = loops.front().T_from_to;
  }
  const std::vector<LoopVote> votes = vote(walk.graph, loops, {}, true, {});
  for (const LoopVote& one : votes) {
    EXPECT_FALSE(one.accepted);
  }
  EXPECT_TRUE(std::ranges::any_of(
      votes, [](const LoopVote& one) { return one.objection == LoopObjection::places; }));
}

TEST(LoopsByAppearance, WhatAcceptedLoopsContradictStaysOut) {
  const Walk walk = drifting_round(false);
  std::vector<LoopHypothesis> before;
  std::vector<LoopHypothesis> loops;
  for (NodeId i = 1; i <= 4; ++i) {
    before.push_back(loop(walk, i, kRoundOfWalk + i));
    loops.push_back(loop(walk, i + 4, kRoundOfWalk + i + 4, up(1.2)));
  }
  EXPECT_EQ(accepted(walk, loops), 4U);
  EXPECT_EQ(accepted(walk, loops, {.accepted = before}), 0U);
}

/// A corridor of 40 m, up a staircase, and back above it; or, `around`, a round of 40 m, which a
/// loop has closed, up a spiral staircase, and the same round above. The odometry is good.
Walk two_floors(bool around) {
  Walk walk;
  walk.start();
  const Eigen::Isometry3d none = Eigen::Isometry3d::Identity();
  const auto go = [&](double ahead, double climb, double turn) {
    Eigen::Isometry3d way = step(ahead, turn);
    way.translation().z() = climb;
    walk.go(way, none);
  };
  for (int i = 0; i < 40; ++i) {
    go(1.0, 0.0, around ? 0.05 * std::numbers::pi : 0.0);
  }
  if (around) {
    PoseEdge closed = edge(0, 40, walk.truth[0].inverse() * walk.truth[40], 1e4);
    walk.graph.add_edge(closed);
  }
  for (int i = 0; i < 8; ++i) {
    go(1.0, 0.425,
       around ? 0.25 * std::numbers::pi : (i == 3 || i == 4 ? 0.5 * std::numbers::pi : 0.0));
  }
  for (int i = 0; i < 40; ++i) {
    go(1.0, 0.0, around ? 0.05 * std::numbers::pi : 0.0);
  }
  return walk;
}

/// The keyframe of the first floor below (or beside) this one, and what an alignment with it finds.
LoopHypothesis twin(const Walk& walk, NodeId to) {
  const Eigen::Vector3d below =
      walk.truth[static_cast<std::size_t>(to)].translation() - Eigen::Vector3d(0.0, 0.0, 3.4);
  NodeId from = 0;
  for (NodeId i = 0; i <= 40; ++i) {
    const auto apart = [&](NodeId id) {
      return (walk.truth[static_cast<std::size_t>(id)].translation() - below).norm();
    };
    from = apart(i) < apart(from) ? i : from;
  }
  return loop(walk, from, to, up(-3.4));
}

/// What comes of all claims, five keyframes at a time, as the queue has them.
std::size_t accepted_twins(const Walk& walk, bool remember) {
  std::vector<LoopHypothesis> refuted;
  std::size_t count = 0;
  for (NodeId first = 49; first + 5 < static_cast<NodeId>(walk.truth.size()); ++first) {
    std::vector<LoopHypothesis> queue;
    for (NodeId to = first; to < first + 5; ++to) {
      queue.push_back(twin(walk, to));
    }
    const std::vector<LoopVote> votes = vote(walk.graph, queue, {.refuted = refuted}, true, {});
    for (const LoopVote& one : votes) {
      count += one.accepted ? 1U : 0U;
    }
    if (remember && votes.front().objection == LoopObjection::odometry) {
      refuted.push_back(queue.front());
    }
  }
  return count;
}

TEST(LoopsByAppearance, AFloorLikeTheOneBelowIsNoPlaceSeenAgain) {
  for (const bool around : {false, true}) {
    for (const bool remembers : {false, true}) {
      EXPECT_EQ(accepted_twins(two_floors(around), remembers), 0U) << around << remembers;
    }
  }
}

// A wing of 30 m, 346 m of corridors round a block, and a wing like the first 16 m aside: 4.3 % of
// the path. The odometry knows the place to half a metre, and is right.
TEST(LoopsByAppearance, NorIsARepeatedWingWithinAFewPerCentOfThePath) {
  Walk walk;
  walk.start();
  constexpr std::array kSides{40, 110, 70, 126};
  std::vector<double> turns(30, 0.0);
  for (const int side : kSides) {
    turns.insert(turns.end(), static_cast<std::size_t>(side), 0.0);
    turns.back() = -0.5 * std::numbers::pi;
  }
  turns.insert(turns.end(), 60, 0.0);
  for (const double turn : turns) {
    walk.go(step(1.0, turn), Eigen::Isometry3d::Identity());
  }
  walk.graph = walk.graph.with_information(
      [](const PoseEdge& edge) -> Matrix6d { return 0.1 * edge.information; });
  std::size_t alike = 0;
  for (NodeId first = 376; first + 5 < static_cast<NodeId>(walk.truth.size()); ++first) {
    std::vector<LoopHypothesis> queue;
    for (NodeId to = first; to < first + 5; ++to) {
      const Eigen::Vector3d here = walk.truth[static_cast<std::size_t>(to)].translation();
      for (NodeId from = 0; from < 30; ++from) {
        const Eigen::Vector3d off = here - walk.truth[static_cast<std::size_t>(from)].translation();
        if (std::abs(off.x()) < 0.5) {
          Eigen::Isometry3d shift = Eigen::Isometry3d::Identity();
          shift.translation().y() = -off.y();
          EXPECT_LT(std::abs(off.y()), 0.05 * static_cast<double>(to - from));
          queue.push_back(loop(walk, from, to, shift));
          ++alike;
        }
      }
    }
    EXPECT_EQ(accepted(walk, queue), 0U) << first;
  }
  EXPECT_GT(alike, 50U);
}

TEST(LoopsByAppearance, NeitherAParallelCorridorNorAnEqualBlockIs) {
  // Up one corridor of 30 m, 6 m aside, and down the next; blocks of 50 m, four in a row.
  Walk corridors;
  Walk blocks;
  corridors.start();
  blocks.start();
  const Eigen::Isometry3d none = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 66; ++i) {
    corridors.go(step(1.0, i == 29 || i == 35 ? 0.5 * std::numbers::pi : 0.0), none);
  }
  for (int i = 0; i < 200; ++i) {
    blocks.go(step(1.0), none);
  }
  Eigen::Isometry3d aside = none;
  aside.translation().y() = -6.0;
  Eigen::Isometry3d back = none;
  back.translation().x() = -50.0;
  std::vector<LoopHypothesis> refuted;
  for (NodeId first = 38; first < 60; ++first) {
    std::vector<LoopHypothesis> queue;
    for (NodeId to = first; to < first + 5; ++to) {
      queue.push_back(loop(corridors, 66 - to, to, aside));
    }
    EXPECT_EQ(accepted(corridors, queue, {.refuted = refuted}), 0U) << first;
    refuted.push_back(queue.front());
  }
  for (NodeId first = 60; first < 190; first += 5) {
    std::vector<LoopHypothesis> queue;
    for (NodeId to = first; to < first + 5; ++to) {
      queue.push_back(loop(blocks, to - 50, to, back));
    }
    EXPECT_EQ(accepted(blocks, queue), 0U) << first;
  }
}

// Round a circle that is known to a few centimetres, three degrees of tilt.
TEST(LoopsByPosition, TellNothingByTiltsWhereNobodyKnowsTheVertical) {
  Walk walk = drifting_round(false, 0.05);
  std::vector<LoopHypothesis> loops;
  for (NodeId i = 1; i <= 5; ++i) {
    LoopHypothesis one = loop(walk, i, kRoundOfWalk + i);
    one.T_from_to.linear() *= Eigen::AngleAxisd(0.06, Eigen::Vector3d::UnitX()).toRotationMatrix();
    loops.push_back(one);
  }
  const auto objection = [&] { return vote(walk.graph, loops, {}, true, {})[0].objection; };
  EXPECT_EQ(objection(), LoopObjection::odometry);
  for (LoopHypothesis& one : loops) {
    one.levelled = false;
  }
  EXPECT_NE(objection(), LoopObjection::odometry);
}

// The odometry climbs 2 cm a metre, as loops have shown; a floor lower, 170 m on, the graph has the
// place where the floor above is.
TEST(ShownDrift, RejectsAFloorThatDriftHasBroughtToAnother) {
  constexpr NodeId kRound = 170;
  Walk walk;
  walk.start();
  for (NodeId i = 0; i < kRound + 4; ++i) {
    Eigen::Isometry3d way = step(1.0, 2.0 * std::numbers::pi / kRound);
    way.translation().z() = i < 8 ? -0.425 : 0.0;
    walk.go(way, up(0.02));
  }
  std::vector<LoopHypothesis> loops;
  for (NodeId i = kRound; i < kRound + 4; ++i) {
    loops.push_back(loop(walk, i - kRound, i));
    loops.back().T_from_to =
        walk.graph.nodes()[static_cast<std::size_t>(i - kRound)].T_map_node.inverse() *
        walk.graph.nodes()[static_cast<std::size_t>(i)].T_map_node;
  }
  EXPECT_EQ(accepted(walk, loops), 4U) << "nothing has been shown";
  EarlierLoops before;
  for (const double way : {30.0, 40.0, 50.0}) {
    DriftDifference shown{.covariance = 1e-4 * Matrix6d::Identity()};
    shown.difference(2) = 0.02 * way;
    shown.response(2, 1) = way;
    before.drift.learn(shown);
  }
  EXPECT_EQ(accepted(walk, loops, before), 0U);
}

}  // namespace
}  // namespace adit
