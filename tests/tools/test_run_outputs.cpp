// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/results/run_outputs.hpp"

#include <filesystem>

#include <gtest/gtest.h>

#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tests/tools/run_support.hpp"
#include "adit/tools/clouds/ply_reader.hpp"
#include "adit/tools/results/trajectory_io.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

/// The message that check_writable() ends with; empty when it is content.
std::string complaint(const fs::path& folder, const MapOptions& map = {}) {
  try {
    check_writable(folder, map);
  } catch (const OutputError& error) {
    return error.what();
  }
  return {};
}

TEST(RunOutputs, CheckMakesTheFolderAndLeavesNothingInIt) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(complaint(folder / "a/b"), "");
  EXPECT_TRUE(fs::is_directory(folder / "a/b"));
  EXPECT_TRUE(fs::is_empty(folder / "a/b"));
}

TEST(RunOutputs, CheckLeavesTheFilesOfAnEarlierRunAsTheyAre) {
  const test::TemporaryFolder folder;
  folder.write("trajectory.tum", "earlier\n");
  EXPECT_EQ(complaint(folder.path()), "");
  EXPECT_EQ(test::content(folder / "trajectory.tum"), "earlier\n");
}

TEST(RunOutputs, CheckNamesTheFileThatCannotBeWritten) {
  const test::TemporaryFolder folder;
  fs::create_directory(folder / "map.ply");
  EXPECT_NE(complaint(folder.path()).find("map.ply: cannot be written"), std::string::npos);
  EXPECT_EQ(complaint(folder.path(), {.enabled = false, .resolution = {}}), "")
      << "no map, no complaint";
  folder.write("file", "");
  EXPECT_NE(complaint(folder / "file").find("file: the output folder cannot be made"),
            std::string::npos);
  EXPECT_NE(complaint(folder / "file/below").find("cannot be made"), std::string::npos);
}

TEST(RunOutputs, EveryLineIsOnTheDiskBeforeTheNextSweep) {
  const test::TemporaryFolder folder;
  test::MemoryRecording recording(3);
  RunOutputs outputs(folder.path(), {});
  for (std::size_t i = 0; i < 3; ++i) {
    outputs.write(test::placed(recording.read(i)), i);
    EXPECT_EQ(test::lines(folder / "trajectory.tum"), i + 1);
    EXPECT_EQ(test::lines(folder / "trajectory.kitti"), i + 1);
    EXPECT_EQ(read_ply(folder / "map.ply").sweep.points.size(), 3 * (i + 1))
        << "as a kill would leave it";
  }
  outputs.close();
  EXPECT_EQ(outputs.map_points(), 9U);
  const Trajectory tum = read_trajectory(folder / "trajectory.tum");
  EXPECT_EQ(tum.poses.at(2).pose.translation().x(), 2.0);
  EXPECT_EQ(tum.poses.at(2).stamp, std::chrono::milliseconds(200));
  const Trajectory kitti = read_trajectory(folder / "trajectory.kitti");
  EXPECT_EQ(kitti.poses.at(1).pose.translation().x(), 1.0);
}

TEST(RunOutputs, AnOdometryThatStartedAnewBeginsAPart) {
  const test::TemporaryFolder folder;
  test::MemoryRecording recording(3);
  RunOutputs outputs(folder.path(), {}, true);
  for (std::size_t i = 0; i < 3; ++i) {
    SweepResult sweep = test::placed(recording.read(i));
    sweep.state = i == 2 ? OdometryState::restarted : sweep.state;
    outputs.write(sweep, i);
  }
  outputs.close();
  for (const char* name : {"trajectory.tum", "odometry.tum"}) {
    const Trajectory written = read_trajectory(folder / name);
    EXPECT_EQ(written.poses.size(), 3U);
    EXPECT_EQ(written.parts, std::vector<std::size_t>{2}) << name;
  }
}

TEST(RunOutputs, MapHoldsKeyframesInTheMapFrame) {
  const test::TemporaryFolder folder;
  test::MemoryRecording recording(3);
  RunOutputs outputs(folder.path(), {});
  SweepResult keyframe = test::placed(recording.read(2));
  keyframe.T_map_lidar.linear() =
      Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  outputs.write(keyframe, 2);
  SweepResult other = test::placed(recording.read(1));
  other.keyframe = false;
  outputs.write(other, 1);
  outputs.close();
  const std::vector<Point> points = read_ply(folder / "map.ply").sweep.points;
  ASSERT_EQ(points.size(), 3U);
  EXPECT_NEAR(points[2].x, 2.0F - 5.0F, 1e-6F);  // 2 m ahead, turned left by 90 degrees
  EXPECT_NEAR(points[2].y, 4.0F, 1e-6F);
  EXPECT_NEAR(points[2].z, 6.0F, 1e-6F);
  EXPECT_EQ(points[2].intensity, 0.7F);
}

TEST(RunOutputs, MapResolutionKeepsTheFirstPointOfEachVoxel) {
  const test::TemporaryFolder folder;
  test::MemoryRecording recording(2);
  RunOutputs outputs(folder.path(), {.enabled = true, .resolution = 0.5});
  outputs.write(test::placed(recording.read(0)), 0);
  outputs.write(test::placed(recording.read(0)), 0);
  outputs.close();
  const std::vector<Point> points = read_ply(folder / "map.ply").sweep.points;
  ASSERT_EQ(points.size(), 2U)
      << "two of the three points share a voxel, and the second sweep adds nothing";
  EXPECT_EQ(points[0].intensity, 0.5F);
  EXPECT_EQ(points[1].intensity, 0.7F);
}

TEST(RunOutputs, ThinningTellsNegativeVoxelsFromPositiveOnesAndKnowsNoEdgeOfTheWorld) {
  MapThinning thinning(1.0);
  EXPECT_TRUE(thinning.take({0.5, 0.5, 0.5}));
  EXPECT_FALSE(thinning.take({0.9, 0.1, 0.99}));
  EXPECT_TRUE(thinning.take({-0.5, 0.5, 0.5}));
  EXPECT_TRUE(thinning.take({0.5, 0.5, -1e9}));
  EXPECT_TRUE(thinning.take({4614123.4, 0.5, 0.5}));
  EXPECT_FALSE(thinning.take({4614123.9, 0.5, 0.5}));
  EXPECT_EQ(thinning.voxels(), 4U);
}

TEST(RunOutputs, ThinningKnowsEachOfManyVoxelsAtBothSidesOfWhereKeysEnd) {
  for (const double from : {-120.0, double{1 << 20} - 60.0, -double{1 << 20} - 60.0}) {
    MapThinning thinning(1.0);
    EXPECT_TRUE(thinning.take({0.0, -7.0, 0.0}));
    for (const bool first : {true, false}) {
      for (int i = 0; i < 120 * 120; ++i) {
        EXPECT_EQ(thinning.take({from + i / 120, 0.5, from + i % 120}), first) << from << " " << i;
      }
    }
    EXPECT_EQ(thinning.voxels(), 120U * 120U + 1U);
  }
}

TEST(RunOutputs, FullDiskIsReportedAndTheOtherFilesAreWhole) {
  const test::TemporaryFolder folder;
  fs::create_symlink("/dev/full", folder / "trajectory.kitti");
  test::MemoryRecording recording(1);
  RunOutputs outputs(folder.path(), {});
  try {
    outputs.write(test::placed(recording.read(0)), 0);
    FAIL() << "the disk is full";
  } catch (const OutputError& error) {
    EXPECT_NE(std::string(error.what()).find("trajectory.kitti"), std::string::npos)
        << error.what();
    EXPECT_NE(std::string(error.what()).find("No space left"), std::string::npos) << error.what();
  }
  try {
    outputs.close();
  } catch (const OutputError&) {
    // Whether the C library reports the same failure a second time is its own affair.
  }
  EXPECT_EQ(read_trajectory(folder / "trajectory.tum").poses.size(), 1U);
  EXPECT_EQ(read_ply(folder / "map.ply").sweep.points.size(), 0U);
}

}  // namespace
}  // namespace adit
