// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/run_loops.hpp"

#include <cmath>
#include <fstream>

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/slam/submaps/submap_codec.hpp"
#include "adit/tests/mapping/graph_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/evaluation/loop_score.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// Twenty places a second and a metre apart, back at the start after ten; keyframes lean by 0.2
/// rad.
class LoopScoring : public testing::Test {
 protected:
  void SetUp() override {
    truth_.file = "truth.tum";
    MapDatabase map(map_, MapAccess::write);
    const SessionId session = map.add_session({.name = "test"});
    Eigen::Isometry3d T_keyframe_lidar = Eigen::Isometry3d::Identity();
    T_keyframe_lidar.linear() = Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()).toRotationMatrix();
    for (NodeId id = 0; id < 20; ++id) {
      const Eigen::Isometry3d lidar = test::step(static_cast<double>(id % 10), 0.1);
      truth_.poses.push_back({.stamp = std::chrono::seconds(id), .pose = lidar});
      truth_keyframes_.push_back(lidar * T_keyframe_lidar.inverse());
      KeyframeSubmap submap{.r_submap = 0.2, .sweeps = {}, .points = {}};
      submap.sweeps.push_back({.stamp = std::chrono::seconds(id),
                               .T_keyframe_lidar = T_keyframe_lidar,
                               .merged = true});
      map.store({.keyframe = {.id = id, .session = session, .stamp = std::chrono::seconds(id)},
                 .submap = encode(submap)});
    }
    map.revise(
        {.candidates = {candidate(2, 12, 0.1, CandidateVerdict::accepted, "none"),
                        candidate(3, 13, 0.7, CandidateVerdict::accepted, "none"),
                        candidate(4, 14, 0.0, CandidateVerdict::rejected, "few_votes"),
                        candidate(5, 15, 3.0, CandidateVerdict::rejected, "beyond_gate"),
                        candidate(6, 16, 0.0, CandidateVerdict::rejected, "too_little_overlap")}});
  }

  LoopCandidate candidate(NodeId from, NodeId to, double off, CandidateVerdict verdict,
                          const char* reason) const {
    return {.from = from,
            .to = to,
            .T_from_to = truth_keyframes_[static_cast<std::size_t>(from)].inverse() *
                         truth_keyframes_[static_cast<std::size_t>(to)] * test::step(off),
            .verdict = verdict,
            .reason = reason};
  }

  fs::path write(const char* text) const {
    std::ofstream(folder_ / "loops.csv") << text;
    return folder_ / "loops.csv";
  }

  /// The message of the refusal; empty where there is none.
  std::string refusal(const std::vector<TrueLoop>& pairs, const Trajectory& truth) const {
    try {
      check_true_loops("loops.csv", pairs, truth);
      static_cast<void>(score_loops(map_, truth, pairs));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  /// Its places are as far apart as in the truth.
  static TrueLoop pair(int earlier, int later) {
    return {.earlier = std::chrono::seconds(earlier),
            .later = std::chrono::seconds(later),
            .distance = std::abs(static_cast<double>(later % 10 - earlier % 10)),
            .overlap = 0.9};
  }

  /// The first poses of the truth alone.
  Trajectory part_of_truth(std::size_t count) const {
    Trajectory part = truth_;
    part.poses.resize(count);
    return part;
  }

  test::TemporaryFolder folder_;
  fs::path map_ = folder_ / "map.adit";
  Trajectory truth_;
  std::vector<Eigen::Isometry3d> truth_keyframes_;
};

TEST_F(LoopScoring, AcceptedEdgesAreHeldAgainstTheTruthAndRevisitsAreFoundByRightOnes) {
  const std::vector<TrueLoop> pairs =
      read_true_loops(write("time_a_s,time_b_s,distance_m,angle_rad,overlap\n"
                            "0.0,10.0,0.1,0.0,0.9\n1.0,12.0,0.1,0.0,0.9\n5.0,14.0,0.1,0.0,0.9\n"
                            "6.0,16.0,0.1,0.0,0.9\n7.0,18.0,9.0,0.0,0.9\n8.0,19.0,0.1,0.0,0.3\n"));
  ASSERT_EQ(pairs.size(), 6U);
  const LoopScore score = score_loops(map_, truth_, pairs);
  EXPECT_EQ(score.accepted, 2U);
  EXPECT_EQ(score.false_ones, 1U) << "the one that is 0.7 m off";
  EXPECT_EQ(score.right_refused, 1U);
  EXPECT_EQ(score.wrong_refused, 1U) << "what was not aligned counts for nothing";
  EXPECT_NEAR(score.loops[0].error.metres, 0.1, 1e-9);
  EXPECT_NEAR(score.loops[1].error.metres, 0.7, 1e-9);
  ASSERT_EQ(score.revisits.size(), 1U)
      << "from 10 s to 16 s: farther or with less in common is none";
  EXPECT_TRUE(score.revisits[0].found);
  EXPECT_NE(describe(score).find("2 accepted, 1 of them false"), std::string::npos);
  EXPECT_EQ(to_json(score).at("false"), 1);
}

TEST_F(LoopScoring, TheLedgerOfTheMapSaysWhatRemovedCandidates) {
  const LoopScore score = score_loops(map_, truth_, {});
  EXPECT_EQ(score.offered, 5U);
  EXPECT_EQ(reasons_text(score.removed), "1 too_little_overlap, 1 beyond_gate, 1 few_votes")
      << "in the order in which it is asked";
  EXPECT_EQ(to_json(score).at("removed").at("few_votes"), 1);
  // What the truth does not cover counts as well: the map has it.
  EXPECT_EQ(score_loops(map_, part_of_truth(13), {}).offered, 5U);
}

TEST_F(LoopScoring, TheSpanReachesFromTheFirstKeyframeOfRightEdgesToTheLast) {
  const LoopScore score = score_loops(map_, truth_, {});
  ASSERT_TRUE(score.span);
  EXPECT_EQ(score.span->begin, std::chrono::seconds(2)) << "3 to 13 is wrong, 4 to 14 was refused";
  EXPECT_EQ(score.span->end, std::chrono::seconds(12));
  MapDatabase(map_, MapAccess::write)
      .revise({.candidates = {candidate(1, 19, 0.0, CandidateVerdict::accepted, "none")}});
  const LoopScore wider = score_loops(map_, truth_, {});
  EXPECT_EQ(wider.span->begin, std::chrono::seconds(1));
  EXPECT_EQ(wider.span->end, std::chrono::seconds(19));
}

TEST_F(LoopScoring, TheErrorBetweenTheEndsOfLoopsLeavesTheTailsOut) {
  Trajectory truth;
  truth.stamped = true;
  for (int i = 0; i < 20; ++i) {
    truth.poses.push_back(
        {.stamp = std::chrono::seconds(i), .pose = test::step(static_cast<double>(i))});
    truth.poses.back().pose.translation().y() = 5.0 * std::sin(0.4 * i);
  }
  // Poses before 2 s and after 12 s are off by 3 m, those of the odometry between by 1 m in turn.
  const auto written = [&](const char* name, double middle) {
    std::vector<StampedPose> poses = truth.poses;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const bool is_tail = i < 2 || i > 12;
      poses[i].pose.translation().z() += is_tail ? 3.0 : i % 2 == 0 ? middle : -middle;
    }
    write_trajectory(folder_ / name, TrajectoryFormat::tum, poses);
    return folder_ / name;
  };
  const LoopSpan span{.begin = std::chrono::seconds(2), .end = std::chrono::seconds(12)};
  const LoopEffect effect =
      loop_effect(written("odometry.tum", 1.0), written("map.tum", 0.0), truth, span, 0.01);
  ASSERT_TRUE(effect.all.map);
  EXPECT_GT(*effect.all.map, 0.5);
  ASSERT_TRUE(effect.in_span.map);
  EXPECT_NEAR(*effect.in_span.map, 0.0, 1e-6);
  ASSERT_TRUE(effect.in_span.odometry);
  EXPECT_GT(*effect.in_span.odometry, 0.5);
  EXPECT_NEAR(effect.span_path,
              path_between(truth, std::chrono::seconds(2), std::chrono::seconds(12)), 1e-9);
  EXPECT_GT(effect.span_path, 10.0);

  const LoopEffect none =
      loop_effect(folder_ / "none.tum", folder_ / "map.tum", truth, std::nullopt, 0.01);
  EXPECT_FALSE(none.all.odometry) << "the file is not there";
  EXPECT_TRUE(none.all.map);
  EXPECT_FALSE(none.in_span.map) << "there is no right loop";
}

TEST_F(LoopScoring, ClosuresOfAnotherSystemAreHeldAgainstTheSameLimits) {
  const auto line = [&](int earlier, int later, double off) {
    const Eigen::Isometry3d T = truth_.poses[static_cast<std::size_t>(earlier)].pose.inverse() *
                                truth_.poses[static_cast<std::size_t>(later)].pose *
                                test::step(off);
    const Eigen::Quaterniond q(T.linear());
    const Eigen::Vector3d t = T.translation();
    return fmt::format("{},{},{},{},{},{},{},{},{}\n", earlier, later, t.x(), t.y(), t.z(), q.x(),
                       q.y(), q.z(), q.w());
  };
  const std::string head = "time_a_s,time_b_s,x,y,z,qx,qy,qz,qw\n";
  const std::vector<MeasuredLoop> loops = read_measured_loops(
      write((head + line(1, 11, 0.4) + line(2, 12, 0.6) + "5,60,0,0,0,0,0,0,1\n").c_str()));
  const MeasuredLoopScore score = score_loops(loops, truth_);
  EXPECT_EQ(score.accepted, 2U);
  EXPECT_EQ(score.false_ones, 1U) << "0.6 m off";
  EXPECT_EQ(score.uncovered, 1U);
  ASSERT_TRUE(score.span);
  EXPECT_EQ(score.span->end, std::chrono::seconds(11));
  for (const char* wrong : {"1,2,0,0,0,0,0,0,0\n", "2,1,0,0,0,0,0,0,1\n", "1,2,x,0,0,0,0,0,1\n"}) {
    EXPECT_THROW(static_cast<void>(read_measured_loops(write((head + wrong).c_str()))), InputError)
        << wrong;
  }
}

TEST_F(LoopScoring, WhatTheTruthDoesNotCoverIsSaid) {
  const std::vector<TrueLoop> pairs = {pair(0, 10), pair(3, 13), pair(6, 16)};
  const LoopScore whole = score_loops(map_, truth_, pairs);
  EXPECT_EQ(whole.uncovered, 0U);
  EXPECT_TRUE(warnings_of(whole).empty());

  const LoopScore part = score_loops(map_, part_of_truth(13), pairs);
  EXPECT_EQ(part.accepted, 1U);
  EXPECT_EQ(part.uncovered, 1U) << "3 to 13";
  EXPECT_EQ(part.not_in_truth, 2U) << "pairs at 13 and 16 s";
  EXPECT_EQ(warnings_of(part).size(), 2U);
  EXPECT_NE(describe(part).find("1 more are accepted that the truth does not cover"),
            std::string::npos);
  EXPECT_EQ(to_json(part).at("not_covered"), 1);

  EXPECT_NE(refusal(pairs, part_of_truth(12)).find("covers none of the 2 accepted loops"),
            std::string::npos);
  EXPECT_NE(refusal(pairs, part_of_truth(9)).find("none of its 3 pairs lies within the time"),
            std::string::npos);
}

TEST_F(LoopScoring, RevisitsAfterTheRunAreNotMissed) {
  for (int id = 20; id < 40; ++id) {
    truth_.poses.push_back({.stamp = std::chrono::seconds(id), .pose = test::step(id % 10, 0.1)});
  }
  std::vector<TrueLoop> pairs;
  for (int later = 10; later < 40; ++later) {
    if (later < 17 || later > 30) {
      pairs.push_back(pair(later % 10, later));
    }
  }
  const LoopScore score = score_loops(map_, truth_, pairs);
  ASSERT_EQ(score.revisits.size(), 1U);
  EXPECT_TRUE(score.revisits[0].found);
  EXPECT_EQ(score.not_of_run, 1U);
  EXPECT_NE(describe(score).find("1, 1 of them found; 1 more are before or after the run"),
            std::string::npos)
      << describe(score);
}

TEST_F(LoopScoring, ARevisitIsFoundByAnEdgeInsideItToThatPlaceAlone) {
  const auto found = [&](const std::vector<TrueLoop>& pairs) {
    const LoopScore score = score_loops(map_, truth_, pairs);
    EXPECT_EQ(score.revisits.size(), 1U);
    return score.revisits.at(0).found;
  };
  // The right edge leads from 2 to 12 s.
  EXPECT_TRUE(found({pair(0, 11), pair(3, 14), pair(5, 17)}));
  EXPECT_TRUE(found({pair(2, 13), pair(3, 15), pair(5, 18)})) << "a keyframe before it";
  EXPECT_FALSE(found({pair(2, 14), pair(3, 16), pair(5, 19)})) << "two of them";
  std::vector<TrueLoop> elsewhere = {pair(8, 11), pair(8, 13), pair(8, 16)};
  for (TrueLoop& one : elsewhere) {
    one.distance = 4.0;
  }
  EXPECT_FALSE(found(elsewhere)) << "of a place 6 m from there";
}

TEST_F(LoopScoring, LoopsOfAnotherRecordingAreRefused) {
  EXPECT_EQ(refusal({pair(0, 10), pair(1, 14)}, truth_), "");
  TrueLoop off = pair(0, 14);
  off.distance = 0.1;
  EXPECT_NE(refusal({pair(0, 10), off}, truth_).find("it is not of the recording that the truth"),
            std::string::npos);
  EXPECT_EQ(refusal({}, truth_), "") << "a recording may have none";
}

TEST_F(LoopScoring, LineEndsAndEmptyLinesOfATableDoNotMatter) {
  const std::vector<TrueLoop> pairs = read_true_loops(
      write("time_a_s,time_b_s,distance_m,angle_rad,overlap\r\n0.0,10.0,0.1,0.0,0.9\r\n\r\n\n"));
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0].later, std::chrono::seconds(10));
  EXPECT_EQ(pairs[0].overlap, 0.9);
  const std::vector<TrueLoop> none =
      read_true_loops(write("time_a_s,time_b_s,distance_m,angle_rad,overlap\n"));
  EXPECT_TRUE(none.empty());
  EXPECT_NE(describe(score_loops(map_, truth_, none)).find("the table holds no pair"),
            std::string::npos);
}

TEST_F(LoopScoring, ATableThatIsNoneIsNamedWithItsLine) {
  for (const char* text : {"", "a,b\n1,2\n", "time_a_s,time_b_s,distance_m,overlap\n1,2,x,4\n",
                           "time_a_s,time_b_s,distance_m,overlap\n1,2\n",
                           "time_a_s,time_b_s,distance_m,overlap\n2,1,0,1\n"}) {
    EXPECT_THROW(static_cast<void>(read_true_loops(write(text))), InputError) << text;
  }
}

}  // namespace
}  // namespace adit
