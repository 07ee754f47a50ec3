// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/demo_drive.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "slam/lie.hpp"

namespace adit {
namespace {

constexpr double kDegree = 0.017453292519943295;

TEST(DemoDrive, IsSmoothStartsInMotionAndTurnsBothWays) {
  const DemoDrive drive = make_demo_drive(100);
  ASSERT_EQ(drive.poses.size(), 100U);
  double leftmost = 0.0;
  double rightmost = 0.0;
  for (std::size_t i = 1; i < drive.poses.size(); ++i) {
    const Eigen::Isometry3d step = drive.poses[i - 1].pose.inverse() * drive.poses[i].pose;
    EXPECT_EQ(drive.poses[i].stamp - drive.poses[i - 1].stamp, std::chrono::milliseconds(100));
    EXPECT_NEAR(step.translation().norm(), 0.65, 0.16) << "5 to 8 m/s, at sweep " << i;
    EXPECT_LT(rotation_angle(step.linear()), 6.0 * kDegree);
    const double yaw = so3_log(step.linear()).z();
    leftmost = std::max(leftmost, yaw);
    rightmost = std::min(rightmost, yaw);
  }
  EXPECT_GT(leftmost, 2.0 * kDegree);
  EXPECT_LT(rightmost, -2.0 * kDegree);
  const Eigen::Isometry3d first = drive.poses[0].pose.inverse() * drive.poses[1].pose;
  EXPECT_GT(first.translation().x(), 0.7) << "in motion from the first sweep on";
}

TEST(DemoDrive, NothingStandsInTheWay) {
  const DemoDrive drive = make_demo_drive(100);
  EXPECT_GT(drive.scene.size(), 100U);
  for (const StampedPose& pose : drive.poses) {
    for (const SceneObject& object : drive.scene) {
      const Eigen::Vector3d lidar = pose.pose.translation();
      EXPECT_GT(
          std::visit([&](const auto& shape) { return distance_to(lidar, shape); }, object.shape),
          2.0);
    }
  }
}

TEST(DemoDrive, ShorterDriveIsTheBeginningOfALongerOne) {
  const DemoDrive shorter = make_demo_drive(5);
  const DemoDrive longer = make_demo_drive(9);
  for (std::size_t i = 0; i < shorter.poses.size(); ++i) {
    EXPECT_TRUE(shorter.poses[i].pose.matrix() == longer.poses[i].pose.matrix());
  }
}

TEST(DemoDrive, PointsOfANoiselessSweepLieOnTheScene) {
  const DemoDrive drive = make_demo_drive(40);
  SpinningLidar lidar;
  lidar.columns = 90;
  lidar.range_noise = 0.0;
  Random random(1);
  const StampedPose& pose = drive.poses.back();
  const Sweep sweep = scan(drive.scene, pose, lidar, random);
  ASSERT_GT(sweep.points.size(), 90U * 16U);
  for (const Point& p : sweep.points) {
    const Eigen::Vector3d world = pose.pose * Eigen::Vector3d(p.x, p.y, p.z);
    double nearest = std::abs(world.z());
    for (const SceneObject& object : drive.scene) {
      nearest = std::min(
          nearest,
          std::visit([&](const auto& shape) { return distance_to(world, shape); }, object.shape));
    }
    EXPECT_LT(nearest, 2e-5) << "float32 at 80 m";
  }
}

TEST(DemoDrive, RangeNoiseHasTheStatedDeviation) {
  const DemoDrive drive = make_demo_drive(1);
  SpinningLidar exact;
  exact.columns = 400;
  exact.range_noise = 0.0;
  SpinningLidar noisy = exact;
  noisy.range_noise = 0.05;
  Random random(3);
  const Sweep truth = scan(drive.scene, drive.poses[0], exact, random);
  const Sweep measured = scan(drive.scene, drive.poses[0], noisy, random);
  ASSERT_EQ(truth.points.size(), measured.points.size());
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < truth.points.size(); ++i) {
    const auto range = [](const Point& p) { return Eigen::Vector3d(p.x, p.y, p.z).norm(); };
    const double error = range(measured.points[i]) - range(truth.points[i]);
    sum += error;
    squares += error * error;
  }
  const auto count = static_cast<double>(truth.points.size());
  EXPECT_NEAR(sum / count, 0.0, 0.003);
  EXPECT_NEAR(std::sqrt(squares / count), 0.05, 0.002);
}

TEST(DemoDrive, SameSeedGivesTheSameSweep) {
  const DemoDrive drive = make_demo_drive(1);
  SpinningLidar lidar;
  lidar.columns = 60;
  Random a(5);
  Random b(5);
  const Sweep one = scan(drive.scene, drive.poses[0], lidar, a);
  const Sweep two = scan(drive.scene, drive.poses[0], lidar, b);
  EXPECT_TRUE(std::ranges::equal(one.points, two.points, [](const Point& p, const Point& q) {
    return p.x == q.x && p.y == q.y && p.z == q.z && p.intensity == q.intensity;
  }));
}

TEST(DemoDrive, RandomNumbersAreThoseOfTheStandardEngine) {
  // The 10000th number of std::mt19937_64 with its default seed is fixed by the C++ standard.
  Random random(5489);
  for (int i = 1; i < 10000; ++i) {
    random.uniform(0, 1);
  }
  EXPECT_EQ(random.uniform(0, 1), static_cast<double>(9981545732273789042ULL >> 11U) * 0x1p-53);
}

}  // namespace
}  // namespace adit
