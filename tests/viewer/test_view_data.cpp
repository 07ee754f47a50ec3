// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/viewer/view_data.hpp"

#include <cstring>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/clouds/ply_writer.hpp"
#include "adit/tools/results/trajectory_io.hpp"
#include "adit/tools/support/usage_error.hpp"
#include "adit/tools/viewer/view_protocol.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// Three keyframes 10 m apart; an accepted loop has the last one 1 m nearer.
void write_map(const fs::path& file) {
  MapDatabase map(file, MapAccess::write);
  const SessionId session = test::add_session(map);
  for (NodeId id = 0; id < 3; ++id) {
    map.store(test::record_of_a_point(id, session));
  }
  const PoseEdge loop = test::edge(0, 2, test::step(19.0), 400.0);
  map.revise({.edges = {loop},
              .candidates = {LoopCandidate{.id = 4,
                                           .from = 0,
                                           .to = 2,
                                           .T_from_to = loop.T_from_to,
                                           .verdict = CandidateVerdict::accepted,
                                           .reason = "none"}}});
}

class ViewDataTest : public testing::Test {
 protected:
  ViewData opened(const fs::path& what, bool edit = false) {
    return ViewData({.what = what, .edit = edit}, progress_);
  }

  test::TemporaryFolder folder_;
  std::ostringstream progress_;
};

TEST_F(ViewDataTest, AMapIsPointsAndAGraph) {
  write_map(folder_ / "map.adit");
  const ViewData data = opened(folder_.path());
  EXPECT_EQ(data.points(), 3U);
  EXPECT_EQ(data.keyframes(), 3U);
  const auto scene = nlohmann::json::parse(data.scene());
  EXPECT_EQ(scene.at("seconds"), 0.2);
  EXPECT_EQ(scene.at("sweeps").at("keyframe").dump(), "[0,1,2]");
  EXPECT_EQ(scene.at("tiled_poses").size(), 21U);
  EXPECT_FALSE(scene.at("editable").get<bool>());
  const auto graph = nlohmann::json::parse(data.graph());
  EXPECT_EQ(graph.at("keyframes").at("id").dump(), "[0,1,2]");
  EXPECT_EQ(graph.at("keyframes").at("odometry").at(14), 20.0);
  EXPECT_EQ(graph.at("loops").at(0).at("verdict"), "accepted");
  EXPECT_EQ(graph.at("loops").at(0).at("pose").at(0), 19.0);
  EXPECT_TRUE(graph.at("truth").is_null());
  EXPECT_EQ(graph.at("edges").size(), 3U);
  // In the map's axes: the keyframe's variance, which is the same all around.
  EXPECT_NEAR(graph.at("keyframes").at("covariance").at(0).get<double>(), 1.0 / 3.0, 1e-6);

  const std::string tile = data.tile(0);
  ASSERT_EQ(tile.size(), 8U + 3 * sizeof(TilePoint));
  std::array<TilePoint, 3> points;
  std::memcpy(points.data(), tile.data() + 8, sizeof(points));
  EXPECT_EQ(points[0].facts.moment, 0);
  EXPECT_EQ(points[2].facts.moment, 65535);
  EXPECT_EQ(points[2].facts.keyframe, 2);
  EXPECT_EQ(points[2].facts.flags, kMoves | kNoIntensity);
  EXPECT_EQ(data.tile(1), "");
}

TEST_F(ViewDataTest, PointsHaveTheIntensityThatTheRunsCloudHasWhereTheyWereThen) {
  write_map(folder_ / "map.adit");
  PlyWriter cloud(folder_ / "map.ply");
  // The run had all of it 5 m farther on, and the third keyframe is of another one.
  cloud.write(std::vector<Point>{{5.0F, 1.0F, 2.0F, 50.0F}, {15.08F, 1.0F, 2.0F, 25.0F}});
  cloud.close();
  TrajectoryWriter trajectory(folder_ / "trajectory.tum", TrajectoryFormat::tum);
  for (NodeId id = 0; id < 2; ++id) {
    trajectory.write({.stamp = test::record(id, 0).keyframe.stamp,
                      .pose = test::step(5.0 + 10.0 * static_cast<double>(id), 0.0)});
  }
  trajectory.close();
  const auto has_intensity = [&] {
    return nlohmann::json::parse(opened(folder_.path()).scene()).at("intensity").get<bool>();
  };
  std::ofstream(folder_ / "summary.json") << R"({"output": {"map_points": 1}})";
  EXPECT_FALSE(has_intensity()) << "the cloud is of another run";
  std::ofstream(folder_ / "summary.json") << R"({"output": {"map_points": 2}})";
  EXPECT_TRUE(has_intensity());
  const ViewData data = opened(folder_.path());
  std::array<TilePoint, 3> points;
  std::memcpy(points.data(), data.tile(0).data() + 8, sizeof(points));
  EXPECT_EQ(points[0].facts.intensity, 255);
  EXPECT_EQ(points[0].facts.flags, 0);
  EXPECT_EQ(points[1].facts.intensity, 127) << "of the cube beside it";
  EXPECT_EQ(points[2].facts.flags, kMoves | kNoIntensity);

  std::ofstream(folder_ / "map.ply") << "ply\nformat ascii 1.0\n";
  EXPECT_FALSE(has_intensity());
  EXPECT_NE(progress_.str().find("points have no intensity"), std::string::npos);
}

TEST_F(ViewDataTest, TheTruthIsLaidOverTheMapAnewAfterAnEdit) {
  write_map(folder_ / "map.adit");
  int asked = 0;
  ViewData data({.what = folder_ / "map.adit",
                 .edit = true,
                 .truth =
                     [&](const MapDatabase&) {
                       ++asked;
                       return ViewTruth{.errors = {{1, 0.25}}, .path = {Eigen::Vector3d(1, 2, 3)}};
                     }},
                progress_);
  EXPECT_EQ(nlohmann::json::parse(data.graph()).at("truth").dump(),
            R"({"error":[null,0.25,null],"path":[1.0,2.0,3.0]})");
  data.change(4, LoopAction::revoke);
  EXPECT_EQ(asked, 2);
  std::ofstream(folder_ / "cloud.ply");
  EXPECT_THROW(ViewData({.what = folder_ / "cloud.ply",
                         .truth = [](const MapDatabase&) { return ViewTruth{}; }},
                        progress_),
               UsageError);
}

TEST_F(ViewDataTest, RevokesAndRestoresWhereItMayEdit) {
  write_map(folder_ / "map.adit");
  ViewData data = opened(folder_ / "map.adit", true);
  const std::string scene = data.scene();
  const ViewAnswer restored_twice = answer_to(data, R"({"restore": 4})");
  EXPECT_NE(restored_twice.reply.find("can be restored"), std::string::npos)
      << restored_twice.reply;
  EXPECT_TRUE(restored_twice.to_all.empty());

  const ViewAnswer revoked = answer_to(data, R"({"revoke": 4})");
  EXPECT_TRUE(revoked.understood);
  EXPECT_NE(revoked.reply.find("Loop 4 is revoked"), std::string::npos) << revoked.reply;
  EXPECT_EQ(nlohmann::json::parse(revoked.to_all).at("loops").at(0).at("verdict"), "revoked");
  EXPECT_EQ(MapDatabase(folder_ / "map.adit", MapAccess::read).candidates()[0].verdict,
            CandidateVerdict::revoked);
  const ViewAnswer restored = answer_to(data, R"({"restore": 4})");
  const double x = nlohmann::json::parse(restored.to_all).at("keyframes").at("pose").at(14);
  EXPECT_LT(x, 19.9);
  EXPECT_EQ(data.scene(), scene);
  EXPECT_NE(answer_to(data, R"({"revoke": 5})").reply.find("no loop 5"), std::string::npos);
}

TEST_F(ViewDataTest, APlaceIsAskedForByThreeNumbers) {
  write_map(folder_ / "map.adit");
  std::ofstream(folder_ / "sweeps.csv") << "stamp_s,overlap\n1700000000.2,0.5\n";
  ViewData data = opened(folder_.path());
  const ViewAnswer answer = answer_to(data, R"({"place": [1, -2.5, 3e0]})");
  EXPECT_TRUE(answer.understood);
  EXPECT_EQ(answer.reply, R"({"type":"place","p":[1.0,-2.5,3.0],"world":null})");
  for (const char* wrong : {R"({"place": 1})", R"({"place": [1, 2]})", R"({"place": [1, 2, "3"]})",
                            R"({"place": [1, 2, 1e999]})"}) {
    EXPECT_FALSE(answer_to(data, wrong).understood) << wrong;
  }
  const auto scene = nlohmann::json::parse(data.scene());
  EXPECT_EQ(scene.at("map"), (folder_ / "map.adit").string());
  EXPECT_EQ(scene.at("plots").at("curves").at(0).at("least").dump(), "[0.5]");
}

TEST_F(ViewDataTest, ADeviceThatFailsIsToldOf) {
  write_map(folder_ / "map.adit");
  ViewData data({.what = folder_ / "map.adit",
                 .edit = true,
                 .verify = [](const MapDatabase&, const LoopByHand&) -> LoopVerification {
                   throw std::runtime_error("no Vulkan device");
                 }},
                progress_);
  EXPECT_NE(answer_to(data, R"({"add": [0, 1]})").reply.find("no Vulkan device"),
            std::string::npos);
}

TEST_F(ViewDataTest, WithoutLeaveNothingIsEdited) {
  write_map(folder_ / "map.adit");
  ViewData data = opened(folder_ / "map.adit");
  EXPECT_NE(answer_to(data, R"({"revoke": 4})").reply.find("--edit"), std::string::npos);
  EXPECT_NE(answer_to(data, R"({"add": [0, 1]})").reply.find("--edit"), std::string::npos);
  EXPECT_FALSE(answer_to(data, R"({"add": [0]})").understood);
  EXPECT_EQ(MapDatabase(folder_ / "map.adit", MapAccess::read).candidates()[0].verdict,
            CandidateVerdict::accepted);
}

TEST_F(ViewDataTest, ACloudHasItsIntensitiesAndARunsTrajectory) {
  std::ofstream(folder_ / "map.ply")
      << "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
         "property float y\nproperty float z\nproperty float intensity\n"
         "end_header\n0 0 0 0\n1 0 0 50\nnan 0 0 7\n";
  std::ofstream(folder_ / "trajectory.tum") << "1.5 0 0 0 0 0 0 1\n3.5 1 2 3 0 0 0 1\n";
  const ViewData data = opened(folder_.path());
  EXPECT_EQ(data.points(), 2U);
  const auto scene = nlohmann::json::parse(data.scene());
  EXPECT_TRUE(scene.at("intensity").get<bool>());
  EXPECT_EQ(scene.at("seconds"), 2.0);
  EXPECT_EQ(scene.at("sweeps").at("keyframe").dump(), "[-1,-1]");
  EXPECT_EQ(scene.at("sweeps").at("pose").at(8), 2.0);
  EXPECT_TRUE(nlohmann::json::parse(data.graph()).at("loops").empty());
  EXPECT_THROW(opened(folder_ / "map.ply", true), UsageError);
}

TEST_F(ViewDataTest, ReadingEndsWhereThatIsWanted) {
  write_map(folder_ / "map.adit");
  const ViewDataOptions options{.what = folder_.path(), .stop = [] { return true; }};
  EXPECT_THROW(ViewData(options, progress_), ViewStopped);
}

TEST_F(ViewDataTest, WhatCannotBeShownSaysWhatCan) {
  const auto said = [&](const fs::path& what) -> std::string {
    try {
      opened(what);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_NE(said(folder_.path()).find("neither map.adit nor map.ply"), std::string::npos);
  EXPECT_NE(said(folder_ / "none.adit").find("none.adit"), std::string::npos);
  std::ofstream(folder_ / "drive.mcap") << "x";
  EXPECT_NE(said(folder_ / "drive.mcap").find("adit run"), std::string::npos);
  EXPECT_FALSE(is_shown_as_it_is(folder_ / "drive.mcap"));
  EXPECT_FALSE(is_shown_as_it_is(folder_.path()));
  EXPECT_TRUE(is_shown_as_it_is(folder_ / "none.adit"));
  std::ofstream(folder_ / "empty.ply")
      << "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
         "property float z\nend_header\nnan nan nan\n";
  EXPECT_NE(said(folder_ / "empty.ply").find("no point that is anywhere"), std::string::npos);
  PlyWriter(folder_ / "none.ply").close();
  EXPECT_NE(said(folder_ / "none.ply").find("it holds no points"), std::string::npos);
}

}  // namespace
}  // namespace adit
