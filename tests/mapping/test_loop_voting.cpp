// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/loops/loop_voting.hpp"

#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "adit/tests/mapping/graph_support.hpp"

namespace adit {
namespace {

using test::edge;
using test::step;

constexpr int kRound = 48;  // keyframes a round

/// Once round a circle, 2 m a step, and a little of the second round; the odometry knows each step
/// to `sigma` m and a tenth of that in rad, and has drifted by as much in yaw a step as `drift`
/// rad.
struct Round {
  std::vector<Eigen::Isometry3d> truth;
  PoseGraph graph;
};

Round round_trip(double drift, double sigma) {
  Round round;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d believed = pose;
  const double turn = 2.0 * std::numbers::pi / kRound;
  for (NodeId id = 0; id < kRound + 10; ++id) {
    round.truth.push_back(pose);
    round.graph.add_node({.id = id, .T_map_node = believed});
    if (id > 0) {
      PoseEdge way = edge(id - 1, id, step(2.0, turn + drift));
      way.information = test::diagonal_covariance(sigma, 0.1 * sigma).inverse();
      round.graph.add_edge(way);
    }
    pose = pose * step(2.0, turn);
    believed = believed * step(2.0, turn + drift);
  }
  return round;
}

const Matrix6d kLoopCovariance = test::diagonal_covariance(0.03, 0.003);

Vector6d drawn(std::mt19937& engine, double translation, double rotation) {
  std::normal_distribution<double> normal;
  Vector6d xi;
  for (int i = 0; i < 6; ++i) {
    xi(i) = (i < 3 ? translation : rotation) * normal(engine);
  }
  return xi;
}

LoopHypothesis loop(const Round& round, NodeId from, NodeId to,
                    const Vector6d& off = Vector6d::Zero()) {
  const Eigen::Isometry3d truth = round.truth[static_cast<std::size_t>(from)].inverse() *
                                  round.truth[static_cast<std::size_t>(to)];
  return {.id = 100 * to + from,
          .from = from,
          .to = to,
          .T_from_to = retract(truth, off),
          .covariance = kLoopCovariance};
}

std::vector<int64_t> accepted(const Round& round, const std::vector<LoopHypothesis>& all,
                              const std::vector<LoopHypothesis>& before = {},
                              bool last_chance = true) {
  const std::vector<LoopVote> votes = vote(round.graph, all, {.accepted = before}, last_chance, {});
  std::vector<int64_t> ids;
  for (std::size_t i = 0; i < votes.size(); ++i) {
    if (votes[i].accepted) {
      EXPECT_EQ(votes[i].objection, LoopObjection::none);
      ids.push_back(all[i].id);
    }
  }
  return ids;
}

TEST(LoopVoting, ThreeGoodOnesAmongTwentyOutliersGiveExactlyThose) {
  const Round round = round_trip(0.0003, 0.03);
  std::size_t plausible = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 engine(seed);
    std::uniform_int_distribution<NodeId> earlier(0, 20);
    std::uniform_int_distribution<NodeId> later(kRound + 2, kRound + 6);
    std::vector<LoopHypothesis> all;
    std::vector<int64_t> good;
    for (NodeId i = 0; i < 3; ++i) {
      all.push_back(loop(round, 2 + 2 * i, kRound + 2 + 2 * i, drawn(engine, 0.02, 0.002)));
      good.push_back(all.back().id);
    }
    for (int i = 0; i < 20; ++i) {
      all.push_back(loop(round, earlier(engine), later(engine), drawn(engine, 1.5, 0.05)));
      all.back().id = -i - 1;
      plausible += odometry_disagreement(round.graph, all.back()) < 16.81 ? 1U : 0U;
    }
    std::ranges::stable_sort(all, {}, &LoopHypothesis::to);
    EXPECT_EQ(accepted(round, all), good) << "seed " << seed;
  }
  EXPECT_GT(plausible, 10U) << "that the odometry does not contradict";
}

TEST(LoopVoting, WrongOnesThatAgreeButContradictTheOdometryGiveNothing) {
  // An identical corridor 6 m aside: every keyframe finds it, and all agree.
  const Round round = round_trip(0.0, 0.02);
  std::vector<LoopHypothesis> all;
  for (NodeId i = 0; i < 5; ++i) {
    LoopHypothesis wrong = loop(round, 2 + i, kRound + 2 + i);
    Eigen::Isometry3d shift = Eigen::Isometry3d::Identity();  // shift of the world, alike for all
    shift.translation().y() = 6.0;
    wrong.T_from_to = round.truth[static_cast<std::size_t>(2 + i)].inverse() * shift *
                      round.truth[static_cast<std::size_t>(kRound + 2 + i)];
    wrong.strong = true;
    all.push_back(wrong);
  }
  EXPECT_LT(disagreement(round.graph, all[0], all[4]), 1.0) << "they do agree";
  const std::vector<LoopVote> votes = vote(round.graph, all, {}, true, {});
  for (const LoopVote& one : votes) {
    EXPECT_FALSE(one.accepted);
    EXPECT_EQ(one.objection, LoopObjection::odometry);
    EXPECT_GT(one.odometry_chi2, 16.81);
  }
}

// An odometry that does not know its height to a storey, and is right: all that speaks for the
// floor below is that it is built like this one.
TEST(LoopVoting, AFloorThatTheOdometryBearsOutInAllButItsHeightStaysAnotherFloor) {
  const Round round = round_trip(0.0, 0.3);
  const auto votes = [&](double height) {
    std::vector<LoopHypothesis> all;
    for (NodeId i = 0; i < 5; ++i) {
      all.push_back(loop(round, 2 + i, kRound + 2 + i));
      all.back().T_from_to = test::up(height) * all.back().T_from_to;
      EXPECT_LT(odometry_disagreement(round.graph, all.back()), 16.81) << "it is borne out";
    }
    return vote(round.graph, all, {}, true, {});
  };
  for (const LoopVote& one : votes(3.4)) {
    EXPECT_EQ(one.objection, LoopObjection::odometry);
  }
  for (const LoopVote& one : votes(1.0)) {  // 1 % of 96 m
    EXPECT_TRUE(one.accepted);
  }
}

TEST(LoopVoting, AKeyframeHasOneVoteHoweverManyNeighboursItMatches) {
  const Round round = round_trip(0.0, 0.1);
  std::vector<LoopHypothesis> all;
  for (NodeId from = 0; from < 5; ++from) {
    all.push_back(loop(round, from, kRound + 2));
  }
  all.push_back(loop(round, 3, kRound + 3));
  const std::vector<LoopVote> votes = vote(round.graph, all, {}, false, {});
  for (const LoopVote& one : votes) {
    EXPECT_FALSE(one.accepted);
    EXPECT_EQ(one.objection, LoopObjection::voters);
    EXPECT_EQ(one.voters, 2U);
  }
  all.push_back(loop(round, 4, kRound + 4));
  EXPECT_EQ(accepted(round, all, {}, false).size(), 3U) << "one of each keyframe, as soon as so";
}

TEST(LoopVoting, WhatContradictsAcceptedLoopsStaysOut) {
  const Round round = round_trip(0.002, 0.15);
  const std::vector<LoopHypothesis> before = {
      loop(round, 0, kRound + 1), loop(round, 1, kRound + 2), loop(round, 2, kRound + 3)};
  std::vector<LoopHypothesis> wrong;
  Eigen::Isometry3d shift = Eigen::Isometry3d::Identity();
  shift.translation().y() = 3.2;
  for (NodeId i = 4; i < 8; ++i) {
    LoopHypothesis one = loop(round, i, kRound + i);
    one.T_from_to = round.truth[static_cast<std::size_t>(i)].inverse() * shift *
                    round.truth[static_cast<std::size_t>(kRound + i)];
    wrong.push_back(one);
  }
  EXPECT_EQ(accepted(round, wrong).size(), 4U) << "within what the odometry drifts by";
  EXPECT_TRUE(accepted(round, wrong, before).empty());
  EXPECT_EQ(vote(round.graph, wrong, {.accepted = before}, true, {})[0].objection,
            LoopObjection::loops);
  PoseGraph with_another_part = round.graph;
  std::vector<LoopHypothesis> with_others = before;
  for (NodeId id = 1000; id < 1020; ++id) {
    with_another_part.add_node({.id = id});
    with_others.push_back({.id = id, .from = 1000, .to = id});
  }
  EXPECT_EQ(vote(with_another_part, wrong, {.accepted = with_others}, true, {})[0].objection,
            LoopObjection::loops)
      << "those of another part have no say";
  EXPECT_EQ(
      accepted(round,
               {loop(round, 4, kRound + 4), loop(round, 5, kRound + 5), loop(round, 6, kRound + 6)},
               before)
          .size(),
      3U)
      << "those that agree with them come in";
}

/// Keyframes along a way, the same way again, and between the two a track that was lost for a
/// while.
struct TwiceAlong {
  PoseGraph graph;
  std::vector<LoopHypothesis> loops;  ///< of each keyframe of the second time with the first time's
};

TwiceAlong twice_along(double corner, double lost_rotation) {
  constexpr NodeId kOnce = 12;
  TwiceAlong made;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (NodeId id = 0; id < 2 * kOnce; ++id) {
    const bool is_lost = id == kOnce;
    Eigen::Isometry3d way = step(2.0, id % kOnce == 6 ? corner : 0.0);
    if (id == 0 || is_lost) {
      way = pose.inverse();  // back to the beginning
    }
    pose = pose * way;
    made.graph.add_node({.id = id, .T_map_node = pose});
    if (id > 0) {
      PoseEdge tie = edge(id - 1, id, way);
      tie.information = (is_lost ? test::diagonal_covariance(9.0, lost_rotation)
                                 : test::diagonal_covariance(0.01, 0.001))
                            .inverse();
      made.graph.add_edge(tie);
    }
    if (id >= kOnce) {
      made.loops.push_back({.id = id,
                            .from = id - kOnce,
                            .to = id,
                            .covariance = kLoopCovariance,
                            .without_heading = true});
    }
  }
  return made;
}

TEST(LoopVoting, AlongOneLineNothingTellsAWayFromTheSameWayBack) {
  const auto count = [](const TwiceAlong& made) {
    std::size_t accepted = 0;
    for (const LoopVote& one : vote(made.graph, made.loops, {}, true, {})) {
      accepted += one.accepted ? 1U : 0U;
    }
    return accepted;
  };
  EXPECT_EQ(count(twice_along(0.0, 1.2)), 0U) << "a corridor, and no heading";
  EXPECT_EQ(count(twice_along(1.5, 1.2)), 12U) << "round a corner";
  EXPECT_EQ(count(twice_along(0.0, 0.1)), 12U) << "the heading is known by now";
}

TEST(LoopVoting, ASingleCrossingComesInAtItsLastChanceIfItIsStrongAndUndisputed) {
  const Round round = round_trip(0.002, 0.15);
  std::vector<LoopHypothesis> one = {loop(round, 2, kRound + 2)};
  EXPECT_TRUE(accepted(round, one).empty()) << "not strong";
  one[0].strong = true;
  EXPECT_TRUE(accepted(round, one, {}, false).empty()) << "others may come yet";
  EXPECT_EQ(accepted(round, one).size(), 1U);
  Vector6d off = Vector6d::Zero();
  off(0) = 2.0;
  one.push_back(loop(round, 3, kRound + 3, off));
  EXPECT_TRUE(accepted(round, one).empty()) << "another one contradicts it";
}

TEST(LoopVoting, LoopsOfPartsThatNothingTiesAreNotAccepted) {
  Round round = round_trip(0.0, 0.1);
  round.graph.set_status(20, EdgeStatus::revoked);
  EXPECT_TRUE(accepted(round, {loop(round, 2, kRound + 2), loop(round, 3, kRound + 3),
                               loop(round, 4, kRound + 4)})
                  .empty());
}

}  // namespace
}  // namespace adit
