// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_optimize.hpp"

#include <array>
#include <cmath>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/slam/graph/solver.hpp"
#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/commands/program.hpp"
#include "adit/tools/map_products/g2o_file.hpp"

namespace adit {
namespace {

/// Three nodes on a line whose third edge is 0.3 m too long: each edge takes 0.1 m.
constexpr const char* kTriangle =
    "VERTEX_SE2 0 0 0 0\n"
    "VERTEX_SE2 1 1 0 0\n"
    "VERTEX_SE2 2 2 0 0\n"
    "EDGE_SE2 0 1 1 0 0 100 0 0 100 0 100\n"
    "EDGE_SE2 1 2 1 0 0 100 0 0 100 0 100\n"
    "EDGE_SE2 0 2 2.3 0 0 100 0 0 100 0 100\n";

test::Ran optimized(const OptimizeCommandOptions& options) {
  return test::ran(optimize_command, options);
}

TEST(OptimizeCommand, WritesTheOptimisedGraphAndSaysWhatItCosts) {
  const test::TemporaryFolder folder;
  const auto input = folder.write("in.g2o", kTriangle);
  const test::Ran ran = optimized({.input = input, .output = folder / "out.g2o"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.err, "");
  EXPECT_NE(ran.out.find("3 nodes, 3 edges (1 loops), SE(2)"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("held         node 0, since none is fixed"), std::string::npos);
  EXPECT_NE(ran.out.find("cost         9 in the file, 3 at the start (chordal), 3 optimized"),
            std::string::npos)
      << ran.out;
  EXPECT_NE(ran.out.find("worst edges"), std::string::npos);
  const PoseGraph graph = read_g2o(folder / "out.g2o").graph;
  EXPECT_NEAR(graph.nodes()[2].T_map_node.translation().x(), 2.2, 1e-9);
}

TEST(OptimizeCommand, ReportsAsJson) {
  const test::TemporaryFolder folder;
  const auto input = folder.write("in.g2o", std::string(kTriangle) + "VERTEX_SE2 9 5 5 0\n");
  const test::Ran ran = optimized({.input = input, .initial = InitialPoses::chordal, .json = true});
  EXPECT_EQ(ran.code, 0) << ran.err;
  for (const char* part : {"\"termination\": \"converged\"", "\"initial\": \"chordal\"",
                           "\"worst_edges\"", "\"line\": 6", "\"first\": 9"}) {
    EXPECT_NE(ran.out.find(part), std::string::npos) << part << " in " << ran.out;
  }
}

TEST(OptimizeCommand, NamesThatAreNoTextAreReported) {
  const test::TemporaryFolder folder;
  const test::Ran ran = optimized({.input = folder.write("d\xe9.g2o", kTriangle), .json = true});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_NE(ran.out.find("d\xef\xbf\xbd.g2o"), std::string::npos) << ran.out;
}

TEST(OptimizeCommand, NamesPartsThatNothingTies) {
  const test::TemporaryFolder folder;
  const auto input = folder.write("in.g2o", std::string(kTriangle) + "VERTEX_SE2 9 5 5 0\n");
  const test::Ran ran = optimized({.input = input});
  EXPECT_EQ(ran.code, 0);
  EXPECT_NE(ran.out.find("components   2, without an edge between them"), std::string::npos);
  EXPECT_NE(ran.out.find("from node 9: 1 nodes, 0 edges, held at its first node"),
            std::string::npos)
      << ran.out;
}

TEST(OptimizeCommand, FailsOnDamagedFilesWithTheirLine) {
  const test::TemporaryFolder folder;
  const test::Ran damaged =
      optimized({.input = folder.write("bad.g2o", std::string(kTriangle) + "EDGE_SE2 0 7 1")});
  EXPECT_EQ(damaged.code, 1);
  EXPECT_NE(damaged.err.find("bad.g2o, line 7: words after EDGE_SE2: 3, expected 11"),
            std::string::npos)
      << damaged.err;
  EXPECT_EQ(optimized({.input = folder / "none.g2o"}).code, 1);
}

TEST(OptimizeCommand, DoesNotWriteOverItsInputNorIntoNoFolder) {
  const test::TemporaryFolder folder;
  const auto input = folder.write("in.g2o", kTriangle);
  EXPECT_EQ(optimized({.input = input, .output = input}).code, 2);
  EXPECT_EQ(optimized({.input = input, .output = folder / "none/out.g2o"}).code, 1);
}

TEST(OptimizeCommand, SaysWhereIterationsDidNotDo) {
  const test::TemporaryFolder folder;
  const auto input = folder.write(
      "in.g2o", std::string(kTriangle) + "EDGE_SE2 0 2 1.5 0.7 0.9 100 0 0 100 0 100\n");
  const test::Ran ran =
      optimized({.input = input, .output = folder / "out.g2o", .max_iterations = 1});
  EXPECT_EQ(ran.code, 1);
  EXPECT_NE(ran.err.find("not converged after 1 iterations"), std::string::npos) << ran.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "out.g2o")) << "what there is, is written";
}

TEST(OptimizeCommand, TakesItsOptionsFromTheCommandLine) {
  const test::TemporaryFolder folder;
  const std::string input = folder.write("in.g2o", kTriangle).string();
  const auto code = [&](auto... words) {
    const std::array<const char*, sizeof...(words) + 3> line = {"adit", "optimize", input.c_str(),
                                                                words...};
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int result = program(static_cast<int>(line.size()), line.data());
    static_cast<void>(testing::internal::GetCapturedStdout());
    static_cast<void>(testing::internal::GetCapturedStderr());
    return result;
  };
  EXPECT_EQ(code("--convention", "se3", "--initial", "tree", "--loop-kernel", "dcs"), 0);
  EXPECT_EQ(code("--convention", "half"), 2);
  EXPECT_EQ(code("--max-iterations", "0"), 2);
}

TEST(OptimizeCommand, ASecondCallOnAMapWithoutGnssReportsNoChange) {
  const test::TemporaryFolder folder;
  const auto file = folder / "map.adit";
  {
    MapDatabase map(file, MapAccess::write);
    const SessionId session = test::add_session(map);
    for (NodeId id = 0; id < 6; ++id) {
      KeyframeRecord record = test::record(id, session);
      // The map leans by 0.2 rad, which its verticals show.
      record.keyframe.T_map_keyframe =
          Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitX()) * record.keyframe.T_map_keyframe;
      record.keyframe.vertical = Vertical::gravity;
      map.store(record);
    }
    map.revise(test::loops_of_six());
  }
  const auto costs = [&] {
    const auto json = nlohmann::json::parse(optimized({.input = file, .json = true}).out);
    return std::array{json.at("cost_file").get<double>(), json.at("cost_after").get<double>()};
  };
  const auto first = costs();
  EXPECT_GE(first[0], first[1]);
  const auto second = costs();
  EXPECT_NEAR(second[0], second[1], 1e-6 * second[1] + 1e-9);
  const test::Ran third = optimized({.input = file});
  EXPECT_EQ(third.code, 0) << third.err;
  EXPECT_NE(third.out.find("wrote        nothing"), std::string::npos) << third.out;
}

TEST(OptimizeCommand, WritesAMapThatHasMovedInTheWorldAlone) {
  const test::TemporaryFolder folder;
  const auto file = folder / "map.adit";
  const Geodetic origin{.latitude = 48.1, .longitude = 11.5, .altitude = 520.0};
  Eigen::Isometry3d too_high = Eigen::Isometry3d::Identity();
  too_high.translation().z() = 1.0;
  {
    MapDatabase map(file, MapAccess::write);
    const SessionId session = test::add_session(map);
    for (NodeId id = 0; id < 3; ++id) {
      KeyframeRecord record = test::record(id, session);
      // All fixes are of one place, the map's origin.
      record.fixes.push_back(
          {.id = id + 1,
           .keyframe = id,
           .stamp = record.keyframe.stamp,
           .place = origin,
           .covariance = Eigen::Matrix3d::Identity() * 0.01,
           .p_keyframe_antenna = record.keyframe.T_map_keyframe.inverse().translation(),
           .verdict = FixVerdict::used,
           .information = Eigen::Matrix3d::Identity() * 100.0});
      map.store(record);
    }
    map.revise({.georeference = Georeference{.origin = origin, .T_world_map = too_high}});
  }
  const test::Ran ran = optimized({.input = file});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_NE(ran.out.find("wrote        the poses"), std::string::npos) << ran.out;
  const MapDatabase after(file, MapAccess::read);
  EXPECT_LT(after.georeference().value().T_world_map.translation().norm(), 1e-3);
  EXPECT_LT(std::abs(after.keyframe(2).value().T_map_keyframe.translation().z()), 1e-6)
      << "which has not moved";
}

}  // namespace
}  // namespace adit
