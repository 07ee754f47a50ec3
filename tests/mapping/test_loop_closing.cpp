// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The mapper with loops, on a street driven up and down again.
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "adit/slam/executor/slam.hpp"
#include "adit/slam/mapping/mapper.hpp"
#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/mapping/graph_support.hpp"
#include "adit/tests/mapping/submap_support.hpp"
#include "adit/tests/support/device_fixture.hpp"

namespace adit {
namespace {

constexpr std::size_t kHalf = 34;  // sweeps

/// 0.5 m a sweep along the street, then backwards along the same way.
const test::SubmapDrive& there_and_back() {
  static const test::SubmapDrive drive = [] {
    test::SubmapDrive made{.truth = test::steady_drive(2 * kHalf, test::twist(0.5)), .sweeps = {}};
    for (std::size_t i = kHalf; i < 2 * kHalf; ++i) {
      made.truth[i].pose = made.truth[2 * kHalf - 1 - i].pose * Eigen::Translation3d(0.0, 0.3, 0.0);
    }
    made.sweeps = test::scan_all(test::make_street(60.0), made.truth, test::small_lidar());
    return made;
  }();
  return drive;
}

class LoopClosing : public test::DeviceTest {
 protected:
  struct Run {
    std::vector<SweepPlaced> sweeps;
    std::optional<MapReport> report;
  };

  static Run run(const Config& config, test::TemporaryMap& map) {
    const auto slam = make_slam(context(), config,
                                {.inertial = false, .map = &map.store(), .session = map.session()});
    Run run;
    const auto drain = [&] {
      while (auto result = slam->next()) {
        run.sweeps.push_back(std::get<SweepPlaced>(std::move(*result)));
      }
    };
    for (const Sweep& sweep : there_and_back().sweeps) {
      slam->add(sweep);
      drain();
    }
    slam->flush();
    drain();
    run.report = slam->finish_map();
    return run;
  }

  /// T_world_keyframe by the truth.
  static std::map<NodeId, Eigen::Isometry3d> true_keyframes(const MapStore& map) {
    std::map<Nanoseconds, Eigen::Isometry3d> truth;
    for (const StampedPose& pose : there_and_back().truth) {
      truth[pose.stamp] = pose.pose;
    }
    std::map<NodeId, Eigen::Isometry3d> keyframes;
    for (const MapKeyframe& keyframe : map.keyframes()) {
      const KeyframeSubmap submap = decode(map.submap(keyframe.id));
      keyframes[keyframe.id] =
          truth.at(keyframe.stamp) * submap.sweeps.front().T_keyframe_lidar.inverse();
    }
    return keyframes;
  }
};

TEST_F(LoopClosing, TheWayBackIsTiedToTheWayThereWhereItReallyIs) {
  test::TemporaryMap map;
  const Run mapped = run(test::loop_config(), map);
  ASSERT_TRUE(mapped.report->loops);
  const LoopReport& loops = *mapped.report->loops;
  EXPECT_GE(loops.accepted, 3U);
  EXPECT_GE(loops.candidates, loops.accepted);
  EXPECT_GE(loops.optimizations, 1U);
  const auto truth = true_keyframes(map.store());
  const PoseGraph graph = map.store().graph();
  std::size_t edges = 0;
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.kind == EdgeKind::loop) {
      ++edges;
      EXPECT_EQ(edge.status, EdgeStatus::active);
      EXPECT_GT(edge.to, edge.from + 5) << "not merely straight on";
      const Eigen::Isometry3d off =
          edge.T_from_to.inverse() * (truth.at(edge.from).inverse() * truth.at(edge.to));
      EXPECT_LT(off.translation().norm(), 0.1);
      EXPECT_LT(rotation_angle(off.linear()), 0.01);
    }
  }
  EXPECT_EQ(edges, loops.accepted);
  for (const PoseNode& node : graph.nodes()) {
    const Eigen::Isometry3d off =
        (there_and_back().truth.front().pose * node.T_map_node).inverse() * truth.at(node.id);
    EXPECT_LT(off.translation().norm(), 0.15);
  }
  EXPECT_TRUE(map.store().check().empty());
}

TEST_F(LoopClosing, EveryCandidateHasItsRecord) {
  test::TemporaryMap map;
  const Run mapped = run(test::loop_config(), map);
  const LoopReport& loops = *mapped.report->loops;
  std::map<CandidateVerdict, std::size_t> verdicts;
  std::map<std::string, std::size_t> reasons;
  for (const LoopCandidate& candidate : map.store().candidates()) {
    ++verdicts[candidate.verdict];
    ++reasons[candidate.reason];
    EXPECT_GT(candidate.overlap, 0.0);
  }
  EXPECT_EQ(map.store().candidates().size(), loops.candidates);
  EXPECT_EQ(verdicts[CandidateVerdict::accepted], loops.accepted);
  EXPECT_EQ(verdicts[CandidateVerdict::waiting], 0U) << "the end of the run decides";
  EXPECT_EQ(reasons["none"], loops.accepted);
  for (std::size_t i = 1; i < kLoopReasons; ++i) {
    EXPECT_EQ(reasons[std::string(to_string(static_cast<LoopReason>(i)))], loops.refused[i]);
  }
}

TEST_F(LoopClosing, TheSameBytesTwiceAndTheOdometryIsTheSameWithoutLoops) {
  test::TemporaryMap first;
  test::TemporaryMap second;
  test::TemporaryMap without;
  const Run mapped = run(test::loop_config(), first);
  run(test::loop_config(), second);
  EXPECT_EQ(first.dump(), second.dump());
  const Run alone = run(test::loop_config(false), without);
  EXPECT_FALSE(alone.report->loops);
  EXPECT_TRUE(without.store().candidates().empty());
  for (std::size_t i = 0; i < alone.sweeps.size(); ++i) {
    EXPECT_EQ(mapped.sweeps[i].result.T_map_lidar.matrix(),
              alone.sweeps[i].result.T_map_lidar.matrix());
  }
}

TEST_F(LoopClosing, ALoopTakesEffectAfterTheDelay) {
  Config config = test::loop_config();
  test::TemporaryMap soon;
  config.mapping.delay = 0;
  const Run now = run(config, soon);
  test::TemporaryMap late;
  config.mapping.delay = 1000;
  const Run end = run(config, late);
  EXPECT_GE(now.report->loops->accepted, 3U);
  EXPECT_GE(end.report->loops->accepted, 3U);
  for (const SweepPlaced& placed : end.sweeps) {
    EXPECT_EQ(placed.mapped->T_map_lidar.matrix(), placed.result.T_map_lidar.matrix());
  }
}

}  // namespace
}  // namespace adit
