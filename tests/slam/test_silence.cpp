// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/silence.hpp"

#include <chrono>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/odometry/motion_model.hpp"

namespace adit {
namespace {

using std::chrono::milliseconds;

Vector6d forward(double speed) {
  Vector6d twist = Vector6d::Zero();
  twist.x() = speed;
  return twist;
}

Silence after(double elapsed, double speed = 1.2) {
  return silence_after(Eigen::Isometry3d::Identity(), forward(speed), speed, elapsed);
}

TEST(Silence, WhatTheSensorMayHaveDoneGrowsWithTime) {
  double before = 0.0;
  for (const double elapsed : {1.01, 1.5, 3.0, 5.0, 15.0, 600.0, 1e9}) {
    const Silence silence = after(elapsed);
    EXPECT_EQ(silence.seconds, elapsed);
    EXPECT_GT(silence.sigma.x(), before) << elapsed;
    EXPECT_TRUE(silence.sigma.allFinite());
    EXPECT_GT(silence.distance, 3.0 * silence.sigma.x()) << elapsed;
    before = silence.sigma.x();
  }
}

// White acceleration of 1 m/s^2 / sqrt(Hz) makes sqrt(t^3 / 3) m at first.
TEST(Silence, OfASecondItIsAsWhiteAccelerationMakesIt) {
  EXPECT_NEAR(after(1.0).sigma.x(), std::sqrt(1.0 / 3.0), 0.05);
  EXPECT_NEAR(after(1.0).sigma.z(), after(1.0).sigma.x(), 1e-12);
}

TEST(Silence, AVelocityCarriesForFiveSecondsAtMost) {
  EXPECT_NEAR(after(1.5).T_map_lidar.translation().x(), 1.2 * 1.3, 0.05);
  EXPECT_NEAR(after(600.0).T_map_lidar.translation().x(), 1.2 * 5.0, 1e-9);
}

TEST(Silence, WhatWasFastMayHaveGoneFarther) {
  EXPECT_GT(after(3.0, 15.0).sigma.x(), 4.0 * after(3.0, 1.0).sigma.x());
  const Silence parked = silence_after(Eigen::Isometry3d::Identity(), forward(0.0), 15.0, 3.0);
  EXPECT_EQ(parked.sigma.x(), after(3.0, 15.0).sigma.x()) << "it may have driven off";
}

TEST(Silence, AVelocityThatIsNotKnownMakesItWider) {
  const Silence unknown = silence_after(Eigen::Isometry3d::Identity(), std::nullopt, 0.0, 2.0);
  EXPECT_GT(unknown.sigma.x(), 1.5 * after(2.0, 0.0).sigma.x());
}

TEST(Silence, OfATurnNoMoreThanTheCircleIsUnknown) {
  EXPECT_LT(after(1e6).sigma.tail<3>().maxCoeff(), 1.82);
}

TEST(Silence, APoseIsMeasuredByWhereTheSensorIsExpected) {
  const Silence silence = after(3.0);
  EXPECT_NEAR(chi2_of(silence, silence.T_map_lidar), 0.0, 1e-12);
  Eigen::Isometry3d away = silence.T_map_lidar;
  away.translation().y() += 2.0 * silence.sigma.y();
  EXPECT_NEAR(chi2_of(silence, away), 4.0, 1e-9);
  away.translation().y() += 3.0 * silence.sigma.y();
  EXPECT_GT(chi2_of(silence, away), kSilenceGate);
}

TEST(Silence, TheMotionModelKnowsTheVelocityBeforeItAndTheHighestSpeed) {
  MotionModel model;
  const auto pose = [](int ms, double x) {
    StampedPose at{milliseconds(ms)};
    at.pose.translation().x() = x;
    return at;
  };
  model.restart(pose(0, 0.0));
  EXPECT_GT(model.silence_until(milliseconds(2000)).sigma.x(), after(2.0, 0.0).sigma.x());
  model.update(pose(100, 1.0), true);
  model.update(pose(200, 2.0), true);
  model.update(pose(300, 2.1), true);
  model.update(pose(400, 2.2), true);
  EXPECT_DOUBLE_EQ(model.unseen(milliseconds(2400)), 2.0);
  const Silence silence = model.silence_until(milliseconds(2400));
  EXPECT_EQ(silence.seconds, 2.0);
  EXPECT_NEAR(silence.T_map_lidar.translation().x(), 2.2 + 1.0 * 1.65, 0.02);
  EXPECT_NEAR(silence.sigma.x(), after(2.0, 10.0).sigma.x(), 1e-9);
}

/// Sweeps at these times, ms.
SweepRhythm rhythm_of(std::initializer_list<int> times, float duration = 0.0F) {
  SweepRhythm rhythm;
  for (const int time : times) {
    Sweep sweep;
    sweep.stamp = milliseconds(time);
    sweep.times = {0.0F, duration};
    rhythm.add(sweep);
  }
  return rhythm;
}

TEST(SweepRhythm, IsTheMedianIntervalOrHowLongASweepLasts) {
  EXPECT_FALSE(SweepRhythm().usual());
  EXPECT_FALSE(rhythm_of({0}).usual()) << "one sweep without times tells nothing";
  EXPECT_NEAR(*rhythm_of({0}, 0.1F).usual(), 0.1, 1e-6);
  EXPECT_NEAR(*rhythm_of({0, 100, 200, 15'000, 15'100}).usual(), 0.1, 1e-9);
  EXPECT_NEAR(*rhythm_of({0, 2000, 4000}, 0.1F).usual(), 2.0, 1e-9);
  EXPECT_NEAR(*rhythm_of({0, 100, 50, 200}).usual(), 0.15, 1e-9) << "back in time is no interval";
}

TEST(Reach, IsTheRangeOfNineInTenReturns) {
  std::vector<Point> points;
  for (int i = 1; i <= 100; ++i) {
    points.push_back({0.0F, static_cast<float>(i), 0.0F, 1.0F});
    points.push_back({0.0F, 0.0F, 0.0F, 1.0F});
    points.push_back({std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F, 1.0F});
  }
  EXPECT_NEAR(reach_of(points), 90.0, 1.0);
  EXPECT_EQ(reach_of({}), 0.0);
}

// Rings in turns: each 64th point would be of the same one.
TEST(Reach, SeesEveryRing) {
  std::vector<Point> points;
  for (int i = 0; i < 64 * 2048; ++i) {
    points.push_back({static_cast<float>(1 + i % 64), 0.0F, 0.0F, 1.0F});
  }
  EXPECT_NEAR(reach_of(points), 58.0, 2.0);
}

}  // namespace
}  // namespace adit
