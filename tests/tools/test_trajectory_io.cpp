// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/results/trajectory_io.hpp"

#include <array>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/support/input_file.hpp"

namespace adit {
namespace {

std::vector<StampedPose> random_poses(std::size_t count) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<StampedPose> poses(count);
  for (std::size_t i = 0; i < count; ++i) {
    poses[i].stamp = Nanoseconds(1623370000123456789 + 100000001 * static_cast<int64_t>(i));
    Vector6d xi;
    xi << 1e3 * normal(random), normal(random), 1e-7 * normal(random), 2.0 * normal(random),
        normal(random), normal(random);
    poses[i].pose = se3_exp(xi);
  }
  return poses;
}

/// The InputError of reading `text` as a trajectory; fails the test where there is none.
InputError input_error(const test::TemporaryFolder& folder, const std::string& text) {
  const std::filesystem::path file = folder.write("bad.txt", text);
  try {
    read_trajectory(file);
  } catch (const InputError& error) {
    EXPECT_EQ(error.file(), file);
    return error;
  }
  ADD_FAILURE() << "accepted: " << text;
  return {"", {}, "", ""};
}

constexpr const char* kTumLine = "1.5 1 2 3 0 0 0 1\n";
constexpr const char* kKittiLine = "1 0 0 7 0 1 0 8 0 0 1 9\n";

TEST(TrajectoryIo, TumReadsBackToTheSamePose) {
  const test::TemporaryFolder folder;
  const std::vector<StampedPose> poses = random_poses(200);
  write_trajectory(folder / "t.tum", TrajectoryFormat::tum, poses);
  const Trajectory read = read_trajectory(folder / "t.tum");
  EXPECT_EQ(read.format, TrajectoryFormat::tum);
  EXPECT_TRUE(read.stamped);
  ASSERT_EQ(read.poses.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(read.poses[i].stamp, poses[i].stamp);
    EXPECT_EQ(read.poses[i].pose.translation(), poses[i].pose.translation());  // bit for bit
    EXPECT_LT((read.poses[i].pose.linear() - poses[i].pose.linear()).cwiseAbs().maxCoeff(), 2e-15);
  }
}

TEST(TrajectoryIo, PartsStayApart) {
  const test::TemporaryFolder folder;
  const std::vector<StampedPose> poses = random_poses(10);
  write_trajectory(folder / "t.tum", TrajectoryFormat::tum, poses, std::array{4UL, 9UL});
  const Trajectory read = read_trajectory(folder / "t.tum");
  EXPECT_EQ(read.poses.size(), poses.size());
  EXPECT_EQ(read.parts, (std::vector<std::size_t>{4, 9}));
  const std::array sizes = {4UL, 5UL, 1UL};
  std::size_t at = 0;
  for (std::size_t part = 1; part <= 3; ++part) {
    const Trajectory one = part_of(read, part);
    EXPECT_TRUE(one.parts.empty());
    ASSERT_EQ(one.poses.size(), sizes[part - 1]);
    EXPECT_EQ(one.poses.front().stamp, poses[at].stamp);
    at += one.poses.size();
  }
  write_trajectory(folder / "t.kitti", TrajectoryFormat::kitti, poses, std::array{4UL});
  EXPECT_EQ(read_trajectory(folder / "t.kitti").poses.size(), poses.size());
}

TEST(TrajectoryIo, KittiTextHoldsEveryBit) {
  const test::TemporaryFolder folder;
  const std::vector<StampedPose> poses = random_poses(200);
  write_trajectory(folder / "t.txt", TrajectoryFormat::kitti, poses);
  const std::string text = read_text_file(folder / "t.txt");
  LineReader lines(text);
  for (const StampedPose& pose : poses) {
    const std::vector<std::string_view> words = split_words(*lines.next());
    ASSERT_EQ(words.size(), 12U);
    for (std::size_t i = 0; i < 12; ++i) {
      const auto row = static_cast<Eigen::Index>(i / 4);
      const auto column = static_cast<Eigen::Index>(i % 4);
      EXPECT_EQ(parse_double(words[i]), pose.pose.matrix()(row, column));
    }
  }
  const Trajectory read = read_trajectory(folder / "t.txt");
  EXPECT_EQ(read.format, TrajectoryFormat::kitti);
  EXPECT_FALSE(read.stamped);
  EXPECT_EQ(read.poses.size(), poses.size());
}

TEST(TrajectoryIo, TumLinesHaveNineDecimalsAndAPositiveQw) {
  const test::TemporaryFolder folder;
  StampedPose pose;
  pose.stamp = Nanoseconds(-1);
  pose.pose.translation() = Eigen::Vector3d(0.1, -2.0, 1e-7);
  pose.pose.linear() = so3_exp(Eigen::Vector3d(0.0, 0.0, -3.0));
  write_trajectory(folder / "t.tum", TrajectoryFormat::tum, std::vector{pose});
  const std::string text = read_text_file(folder / "t.tum");
  const std::vector<std::string_view> words =
      split_words(std::string_view(text).substr(0, text.size() - 1));
  EXPECT_EQ(words[0], "-0.000000001");
  EXPECT_EQ(words[1], "0.1");
  EXPECT_EQ(words[3], "1e-07");
  EXPECT_GT(parse_double(words[7]).value(), 0.0);
  EXPECT_LT(parse_double(words[6]).value(), 0.0);
}

TEST(TrajectoryIo, FormatsAreToldApartByTheirColumns) {
  const test::TemporaryFolder folder;
  const Trajectory tum = read_trajectory(folder.write("a", kTumLine));
  EXPECT_EQ(tum.poses.at(0).stamp, Nanoseconds(1500000000));
  EXPECT_EQ(tum.poses.at(0).pose.translation(), Eigen::Vector3d(1, 2, 3));
  const Trajectory kitti = read_trajectory(folder.write("b", kKittiLine));
  EXPECT_EQ(kitti.poses.at(0).pose.translation(), Eigen::Vector3d(7, 8, 9));
}

TEST(TrajectoryIo, CommentsBlankLinesAndCarriageReturnsDoNotCount) {
  const test::TemporaryFolder folder;
  const Trajectory read = read_trajectory(
      folder.write("a", "# t x y z\r\n\r\n1 0 0 0 0 0 0 1 # start\r\n\n2 1 0 0 0 0 0 1"));
  ASSERT_EQ(read.poses.size(), 2U);
  EXPECT_EQ(read.poses[1].stamp, Nanoseconds(2000000000));
}

TEST(TrajectoryIo, QuaternionsAreNormalised) {
  const test::TemporaryFolder folder;
  const Trajectory read = read_trajectory(folder.write("a", "0 0 0 0 0 0 2 2\n"));
  EXPECT_LT(
      (read.poses[0].pose.linear() - so3_exp(Eigen::Vector3d(0, 0, 1.5707963267948966))).norm(),
      1e-15);
}

TEST(TrajectoryIo, RoundedRotationsBecomeRotations) {
  const test::TemporaryFolder folder;
  const Trajectory read =
      read_trajectory(folder.write("a", "0.9801 -0.1987 0 1 0.1987 0.9801 0 2 0 0 1 3\n"));
  const Eigen::Matrix3d r = read.poses[0].pose.linear();
  EXPECT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-15);
}

TEST(TrajectoryIo, TruncatedLineNamesFileAndLine) {
  const test::TemporaryFolder folder;
  const InputError error = input_error(folder, std::string(kTumLine) + "2.5 1 2 3 0 0\n");
  EXPECT_EQ(error.place(), "line 2");
  EXPECT_NE(error.found().find("columns found: 6, expected 8"), std::string::npos);
}

TEST(TrajectoryIo, MixedFormatsNameTheLine) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(input_error(folder, "# c\n" + std::string(kTumLine) + kKittiLine).place(), "line 3");
}

TEST(TrajectoryIo, WhatIsNoNumberIsShown) {
  const test::TemporaryFolder folder;
  const InputError error = input_error(folder, "1 2 3 4x 0 0 0 1\n");
  EXPECT_EQ(error.place(), "line 1");
  EXPECT_NE(error.found().find("column 4 is '4x'"), std::string::npos);
}

TEST(TrajectoryIo, NanInfinityAndAbsurdNumbersAreErrors) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(input_error(folder, "1 nan 0 0 0 0 0 1\n").place(), "line 1");
  EXPECT_EQ(input_error(folder, "1 inf 0 0 0 0 0 1\n").place(), "line 1");
  EXPECT_EQ(input_error(folder, "1 1e13 0 0 0 0 0 1\n").place(), "line 1");
  EXPECT_EQ(input_error(folder, "nan 0 0 0 0 0 0 1\n").place(), "line 1");
  EXPECT_EQ(input_error(folder, "1 0 0 7 0 nan 0 8 0 0 1 9\n").place(), "line 1");
}

TEST(TrajectoryIo, ZeroQuaternionIsAnError) {
  const test::TemporaryFolder folder;
  EXPECT_NE(input_error(folder, "1 0 0 0 0 0 0 0\n").found().find("quaternion"), std::string::npos);
}

TEST(TrajectoryIo, MatrixThatIsNoRotationIsAnError) {
  const test::TemporaryFolder folder;
  EXPECT_NE(input_error(folder, "2 0 0 7 0 1 0 8 0 0 1 9\n").found().find("no rotation"),
            std::string::npos);
  EXPECT_NE(input_error(folder, "1 0 0 7 0 1 0 8 0 0 -1 9\n").found().find("no rotation"),
            std::string::npos);
  EXPECT_NE(input_error(folder, "0 0 0 0 0 0 0 0 0 0 0 0\n").found().find("no rotation"),
            std::string::npos);
}

TEST(TrajectoryIo, TimeThatGoesBackwardsIsAnError) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(input_error(folder, "2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n").place(), "line 2");
}

TEST(TrajectoryIo, TimesInNanosecondsAreAnErrorWithAHint) {
  const test::TemporaryFolder folder;
  EXPECT_NE(input_error(folder, "1403715273262140000 0 0 0 0 0 0 1\n").remedy().find("1e9"),
            std::string::npos);
}

TEST(TrajectoryIo, EmptyFileIsAnError) {
  const test::TemporaryFolder folder;
  EXPECT_NE(input_error(folder, "").found().find("no pose"), std::string::npos);
  EXPECT_NE(input_error(folder, "# only comments\n").found().find("no pose"), std::string::npos);
}

TEST(TrajectoryIo, TimesStampAKittiTrajectory) {
  const test::TemporaryFolder folder;
  const std::filesystem::path poses =
      folder.write("poses.txt", std::string(kKittiLine) + kKittiLine);
  const Trajectory read = read_trajectory(poses, folder.write("times.txt", "0.0\n0.1\n"));
  EXPECT_TRUE(read.stamped);
  EXPECT_EQ(read.poses[1].stamp, Nanoseconds(100000000));
  try {
    read_trajectory(poses, folder.write("short.txt", "0.0\n"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.file(), folder / "short.txt");
    EXPECT_EQ(error.place(), "line 2");
  }
}

TEST(TrajectoryIo, FullDiskIsAnErrorThatNamesTheFile) {
  if (!std::filesystem::exists("/dev/full")) {
    GTEST_SKIP() << "needs /dev/full";
  }
  EXPECT_THROW(write_trajectory("/dev/full", TrajectoryFormat::tum, random_poses(2)), OutputError);
}

TEST(TrajectoryIo, LinesAreReadableAsSoonAsTheyAreFlushed) {
  const test::TemporaryFolder folder;
  TrajectoryWriter writer(folder / "t.tum", TrajectoryFormat::tum);
  const std::vector<StampedPose> poses = random_poses(3);
  writer.write(poses[0]);
  writer.write(poses[1]);
  writer.flush();
  EXPECT_EQ(read_trajectory(folder / "t.tum").poses.size(), 2U);
}

TEST(TrajectoryIo, ACommentThatNamesAllColumnsTellsTheirOrder) {
  const test::TemporaryFolder folder;
  const auto file = folder.write(
      "a.tum", "\xef\xbb\xbf# timestamp tx ty tz qw qx qy qz\r\n1.5 1 2 3 0 0 0 1\r\n");
  const Trajectory read = read_trajectory(file);
  ASSERT_EQ(read.poses.size(), 1U);
  EXPECT_EQ(read.poses[0].stamp, std::chrono::milliseconds(1500));
  EXPECT_NEAR(read.poses[0].pose.linear()(0, 0), -1.0, 1e-12);  // half a turn about z
  const auto usual = folder.write("b.tum", "# timestamp tx ty tz q\n1.5 1 2 3 0 0 0 1\n");
  EXPECT_TRUE(read_trajectory(usual).poses[0].pose.linear().isIdentity());
}

}  // namespace
}  // namespace adit
