// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/loop_score.hpp"

#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/slam/mapping/submap_codec.hpp"
#include "adit/tests/mapping/graph_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/maps/map_database.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;

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
      truth_.poses.push_back({.stamp = seconds(id), .pose = lidar});
      truth_keyframes_.push_back(lidar * T_keyframe_lidar.inverse());
      KeyframeSubmap submap{.r_submap = 0.2, .sweeps = {}, .points = {}};
      submap.sweeps.push_back(
          {.stamp = seconds(id), .T_keyframe_lidar = T_keyframe_lidar, .merged = true});
      map.store({.keyframe = {.id = id, .session = session, .stamp = seconds(id)},
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
  EXPECT_NEAR(score.loops[0].metres, 0.1, 1e-9);
  EXPECT_NEAR(score.loops[1].metres, 0.7, 1e-9);
  ASSERT_EQ(score.revisits.size(), 1U)
      << "from 10 s to 16 s: farther or with less in common is none";
  EXPECT_TRUE(score.revisits[0].found);
  EXPECT_NE(describe(score).find("2 accepted, 1 of them false"), std::string::npos);
  EXPECT_EQ(to_json(score).at("false"), 1);
}

TEST_F(LoopScoring, ATableThatIsNoneIsNamedWithItsLine) {
  for (const char* text : {"", "a,b\n1,2\n", "time_a_s,time_b_s,distance_m,overlap\n1,2,x,4\n",
                           "time_a_s,time_b_s,distance_m,overlap\n1,2\n"}) {
    EXPECT_THROW(static_cast<void>(read_true_loops(write(text))), InputError) << text;
  }
}

}  // namespace
}  // namespace adit
