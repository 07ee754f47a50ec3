// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What becomes of loops after their vote: reviews, second tries, parts that are joined, and the
// order in which they leave the queue.
#include <algorithm>
#include <map>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/loops/loop_closer.hpp"
#include "adit/tests/mapping/graph_support.hpp"
#include "adit/tests/mapping/submap_support.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

using test::step;

/// m aside.
Eigen::Isometry3d aside(double y) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation().y() = y;
  return pose;
}

class LoopReview : public test::DeviceTest {
 protected:
  /// A keyframe on, at its true place; known to `sigma`, m.
  void go(const Eigen::Isometry3d& way, double sigma = 0.001) {
    const auto id = static_cast<NodeId>(truth_.size());
    truth_.push_back(truth_.empty() ? Eigen::Isometry3d::Identity() : truth_.back() * way);
    graph_.add_node({.id = id, .T_map_node = truth_.back()});
    if (id > 0) {
      PoseEdge tied = test::edge(id - 1, id, way);
      tied.information = symmetric_inverse(test::diagonal_covariance(sigma, 0.1 * sigma));
      graph_.add_edge(tied);
    }
  }

  /// As verification would leave it: places that lie a shift of the world apart.
  PendingLoop found(NodeId from, NodeId to, const Eigen::Isometry3d& shift, double sigma) {
    const auto at = [&](NodeId id) { return truth_[static_cast<std::size_t>(id)]; };
    const LoopHypothesis loop{.id = ++ids_,
                              .from = from,
                              .to = to,
                              .T_from_to = at(from).inverse() * shift * at(to),
                              .covariance = test::diagonal_covariance(sigma, 0.1 * sigma),
                              .strong = true,
                              .source = LoopSource::appearance};
    return {.loop = loop,
            .record = {.id = loop.id,
                       .from = from,
                       .to = to,
                       .T_from_to = loop.T_from_to,
                       .source = loop.source,
                       .reason = "none"}};
  }

  void take_effect(NodeId keyframe, std::vector<PendingLoop> loops = {}) {
    note(closer_.take_effect(graph_, keyframe, std::move(loops)));
  }
  void note(const LoopCloser::Change& change) {
    for (const LoopCandidate& record : change.records) {
      records_[record.id] = record;
    }
  }

  std::size_t active_loops() const {
    return static_cast<std::size_t>(std::ranges::count_if(graph_.edges(), [](const PoseEdge& edge) {
      return edge.kind == EdgeKind::loop && edge.status == EdgeStatus::active;
    }));
  }

  test::TemporaryMap map_;
  LoopCloser closer_{context(), test::loop_config(), submap_loader(map_.store()), {}};
  std::vector<Eigen::Isometry3d> truth_;
  PoseGraph graph_;
  std::map<int64_t, LoopCandidate> records_;
  int64_t ids_ = 0;
};

// Out, back, and once in between the odometry hardly knows how far: three times loops say it.
TEST_F(LoopReview, WhatWasTakenBackComesInAgainOnceTheGraphIsWhereItHasIt) {
  constexpr NodeId kTurn = 60;
  for (NodeId id = 0; id < kTurn; ++id) {
    go(step(1.0));
  }
  go(step(0.0, std::numbers::pi));
  for (NodeId back = 1; back < kTurn; ++back) {
    go(step(1.0), back == 35 ? 1.0 : 0.001);
  }
  const auto offer = [&](NodeId back, double shift, double sigma) {
    take_effect(kTurn + back, {found(kTurn - 1 - back, kTurn + back, aside(shift), sigma)});
  };
  for (NodeId back = 5; back < 29; ++back) {
    offer(back, 0.0, 0.03);
  }
  ASSERT_EQ(active_loops(), 24U);
  for (NodeId back = 40; back < 43; ++back) {
    offer(back, 0.4, 0.02);
  }
  ASSERT_EQ(active_loops(), 27U) << "all wrong";
  const int64_t right = ids_ + 1;
  for (NodeId back = 45; back < 49; ++back) {
    offer(back, 0.0, 0.06);
  }
  ASSERT_EQ(active_loops(), 27U) << "others say it better";
  for (NodeId back = 50; back < 55; ++back) {
    offer(back, 0.0, 0.01);
  }
  note(closer_.finish(graph_));
  for (int64_t id = right; id < right + 4; ++id) {
    EXPECT_EQ(records_[id].verdict, CandidateVerdict::accepted) << id;
    EXPECT_EQ(records_[id].reason, "none") << id;
    EXPECT_EQ(records_[id].figure, 4.0) << "its votes";
  }
  EXPECT_EQ(records_[right - 1].verdict, CandidateVerdict::revoked);
  EXPECT_EQ(records_[right - 1].reason, "review");
  EXPECT_EQ(closer_.report().accepted, active_loops());
  EXPECT_EQ(closer_.report().refused[static_cast<std::size_t>(LoopReason::review)], 3U);
}

// Out and back: the odometry is right, so that the loops say what the graph has already.
TEST_F(LoopReview, LoopsThatTheGraphFitsWaitForOneOptimisationTogether) {
  constexpr NodeId kTurn = 100;
  for (NodeId id = 0; id < kTurn; ++id) {
    go(step(1.0));
  }
  go(step(0.0, std::numbers::pi));
  for (NodeId back = 1; back < kTurn; ++back) {
    go(step(1.0));
    const std::size_t loops = active_loops();
    const std::size_t optimizations = closer_.report().optimizations;
    if (back > 5) {
      take_effect(kTurn + back, {found(kTurn - 1 - back, kTurn + back, aside(0.0), 0.03)});
    }
    if (active_loops() > loops && active_loops() <= 10) {
      EXPECT_GT(closer_.report().optimizations, optimizations) << "the first ones do not wait";
    }
  }
  const std::size_t before = closer_.report().optimizations;
  EXPECT_LT(before, active_loops() / 2);
  EXPECT_GE(before, 5U);
  note(closer_.finish(graph_));
  EXPECT_EQ(active_loops(), static_cast<std::size_t>(kTurn - 6));
  EXPECT_GT(closer_.report().optimizations, before) << "what waits at the end is not left out";
  for (const auto& [id, record] : records_) {
    EXPECT_EQ(record.verdict, CandidateVerdict::accepted) << id;
    EXPECT_LT(record.chi2, 1.0) << id;
  }
}

// A corridor, left and come back to twice, each time with the odometry begun anew.
TEST_F(LoopReview, ThePartThatTheMapBeginsWithStaysWhereItIs) {
  constexpr NodeId kLong = 15;
  for (NodeId id = 0; id < 3 * kLong; ++id) {
    const auto along = step(static_cast<double>(id % kLong));
    truth_.push_back(along);
    const Eigen::Isometry3d T_map_part = step(0.0, 0.5 * static_cast<double>(id / kLong));
    graph_.add_node({.id = id, .T_map_node = T_map_part * along});
    if (id % kLong != 0) {
      PoseEdge tied = test::edge(id - 1, id, step(1.0));
      tied.information = symmetric_inverse(test::diagonal_covariance(0.001, 0.0001));
      graph_.add_edge(tied);
    }
  }
  const Eigen::Isometry3d nowhere = Eigen::Isometry3d::Identity();
  for (NodeId i = 0; i < kLong; ++i) {  // the third part is tied to the first
    take_effect(2 * kLong + i, {found(i, 2 * kLong + i, nowhere, 0.03)});
  }
  EXPECT_EQ(connected_components(graph_).components.size(), 2U);
  std::vector<PendingLoop> loops;
  for (NodeId i = 0; i < kLong; ++i) {  // and the second to the third
    loops.push_back(found(kLong + i, 2 * kLong + i, nowhere, 0.03));
  }
  take_effect(3 * kLong, std::move(loops));
  EXPECT_EQ(connected_components(graph_).components.size(), 1U);
  EXPECT_LT(graph_.nodes().front().T_map_node.translation().norm(), 1e-9);
  for (const PoseNode& node : graph_.nodes()) {
    const Eigen::Isometry3d off =
        node.T_map_node.inverse() * truth_[static_cast<std::size_t>(node.id)];
    EXPECT_LT(off.translation().norm(), 0.01) << node.id;
    EXPECT_LT(rotation_angle(off.linear()), 0.01) << node.id;
  }
}

// A loop that the odometry bears out is outvoted, and four say that the odometry has drifted.
TEST_F(LoopReview, WhatDisputesALoopDoesNotLeaveForItToComeIn) {
  constexpr NodeId kRound = 60;
  const double turn = 2.0 * std::numbers::pi / static_cast<double>(kRound);
  for (NodeId id = 0; id < kRound + 10; ++id) {
    go(step(1.0, turn));
  }
  PendingLoop borne_out = found(1, kRound + 1, aside(0.0), 0.03);
  borne_out.loop.strong = false;
  take_effect(kRound + 1, {borne_out, found(2, kRound + 1, aside(0.4), 0.03)});
  for (NodeId i = 2; i <= 4; ++i) {
    take_effect(kRound + i, {found(i + 1, kRound + i, aside(0.4), 0.03)});
  }
  EXPECT_TRUE(records_.empty()) << "all are waiting";
  note(closer_.finish(graph_));
  EXPECT_EQ(active_loops(), 0U);
  EXPECT_EQ(records_[1].reason, "few_votes");
  EXPECT_EQ(records_[2].reason, "another_place");
  EXPECT_EQ(records_[3].reason, "few_votes") << "three are left";
}

}  // namespace
}  // namespace adit
