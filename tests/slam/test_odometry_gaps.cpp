// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Two seconds of which nothing at all was recorded, and nobody knows what the sensor did then.
#include <algorithm>
#include <numbers>

#include <gtest/gtest.h>

#include "adit/tests/slam/odometry_fixture.hpp"

namespace adit {
namespace {

using test::Drive;
using test::run_odometry;

class OdometryGapTest : public test::DeviceTest {};

constexpr size_t kGap = 25;  // sweeps before it
constexpr double kGapStep = 0.15;

/// On foot: straight on, a gap of two seconds in which the sensor moves by `jump`, then `forward` m
/// a sweep again.
std::vector<StampedPose> walk(const Eigen::Isometry3d& jump, size_t after) {
  std::vector<StampedPose> poses;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation().z() = 1.8;
  Nanoseconds stamp = std::chrono::seconds(1000);
  for (size_t i = 0; i < kGap + after; ++i) {
    poses.push_back({stamp, pose});
    const bool gap = i + 1 == kGap;
    pose = gap ? pose * jump : pose * Eigen::Translation3d(kGapStep, 0.0, 0.0);
    stamp += gap ? std::chrono::milliseconds(2000) : std::chrono::milliseconds(100);
  }
  return poses;
}

Eigen::Isometry3d jump(double x, double y, double yaw) {
  Eigen::Isometry3d motion(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  motion.translation() << x, y, 0.0;
  return motion;
}

size_t count(const std::vector<SweepResult>& results, OdometryState state) {
  return static_cast<size_t>(std::ranges::count(results, state, &SweepResult::state));
}

TEST_F(OdometryGapTest, ASensorThatHasTurnedIsFoundAgain) {
  const test::World world = test::make_street(100.0);
  for (const double degrees : {-160.0, -90.0, 0.0, 60.0, 130.0}) {
    Drive drive;
    drive.truth = walk(jump(1.2, 0.8, degrees * std::numbers::pi / 180.0), 10);
    drive.sweeps = test::scan_all(world, drive.truth, test::Lidar{});
    const auto results = run_odometry(context(), drive.sweeps);
    EXPECT_EQ(count(results, OdometryState::restarted), 0U) << degrees;
    EXPECT_LE(count(results, OdometryState::coasting), 2U) << degrees;
    for (size_t i = kGap; i < drive.size(); ++i) {
      if (results[i].state == OdometryState::tracking) {
        EXPECT_LE(drive.error(results[i], i).translation, 0.1) << degrees << ", sweep " << i;
      }
    }
  }
}

TEST_F(OdometryGapTest, InAnotherPlaceTheMapStartsAnewAndNothingIsPretendedBefore) {
  Drive drive;
  drive.truth = walk(jump(0.0, 0.0, 0.5), 20);
  drive.sweeps = test::scan_all(test::make_street(100.0, 1), drive.truth, test::Lidar{});
  const std::vector<Sweep> elsewhere =
      test::scan_all(test::make_street(100.0, 7), drive.truth, test::Lidar{});
  std::copy(elsewhere.begin() + kGap, elsewhere.end(), drive.sweeps.begin() + kGap);
  const auto results = run_odometry(context(), drive.sweeps);
  const auto anew = std::ranges::find(results, OdometryState::restarted, &SweepResult::state);
  ASSERT_NE(anew, results.end());
  const auto at = static_cast<size_t>(anew - results.begin());
  EXPECT_EQ(at, kGap + 5);
  for (size_t i = kGap; i < at; ++i) {
    EXPECT_EQ(results[i].state, OdometryState::coasting) << i;
    // The last velocity is given a second and no more.
    const double gone =
        (results[i].T_map_lidar.translation() - results[kGap - 1].T_map_lidar.translation()).norm();
    EXPECT_LE(gone, 10 * kGapStep + 0.1) << i;
  }
  for (size_t i = at + 1; i < drive.size(); ++i) {
    EXPECT_EQ(results[i].state, OdometryState::tracking) << i;
    const Eigen::Isometry3d moved = anew->T_map_lidar.inverse() * results[i].T_map_lidar;
    const Eigen::Isometry3d truth = drive.truth[at].pose.inverse() * drive.truth[i].pose;
    EXPECT_LE((moved.translation() - truth.translation()).norm(), 0.1) << i;
  }
}

/// On foot with a silence of `gap` in which the sensor moves by `after`.
Drive interrupted(Nanoseconds gap, const Eigen::Isometry3d& after) {
  Drive drive;
  drive.truth = walk(after, 8);
  for (size_t i = kGap; i < drive.truth.size(); ++i) {
    drive.truth[i].stamp += gap - std::chrono::seconds(2);
  }
  drive.sweeps = test::scan_all(test::make_street(100.0), drive.truth, test::Lidar{});
  return drive;
}

// It did not move, and fits where it was: but so might another street.
TEST_F(OdometryGapTest, AfterALongSilenceTheTrackBeginsAnewWhateverFits) {
  for (const int silence : {60, 600}) {
    const Drive drive = interrupted(std::chrono::seconds(silence), Eigen::Isometry3d::Identity());
    const auto results = run_odometry(context(), drive.sweeps);
    const SweepResult& first = results[kGap];
    EXPECT_EQ(first.state, OdometryState::restarted) << silence;
    EXPECT_NEAR(first.silence, silence, 0.2);
    ASSERT_TRUE(first.rejection);
    const auto* reason = std::get_if<BeyondReach>(&*first.rejection);
    ASSERT_NE(reason, nullptr) << silence;
    EXPECT_GT(reason->distance, reason->reach);
    // What it claims is what may have happened.
    EXPECT_GT(std::sqrt(first.uncertainty.in_map()(0, 0)), silence == 60 ? 30.0 : 100.0);
    EXPECT_EQ(count(results, OdometryState::restarted), 1U);
    for (size_t i = kGap + 1; i < results.size(); ++i) {
      EXPECT_EQ(results[i].state, OdometryState::tracking) << i;
      EXPECT_EQ(results[i].silence, 0.0) << i;
    }
  }
}

TEST_F(OdometryGapTest, AfterAShortSilenceTheClaimHasThatItMayBeAnotherPlace) {
  const Drive drive = interrupted(std::chrono::milliseconds(1500), jump(1.5, 0.0, 0.0));
  const auto results = run_odometry(context(), drive.sweeps);
  const SweepResult& first = results[kGap];
  ASSERT_EQ(first.state, OdometryState::tracking);
  EXPECT_NEAR(first.silence, 1.5, 0.01);
  EXPECT_LE(drive.error(first, kGap).translation, 0.1);
  const auto sigma = [&](size_t i) { return std::sqrt(results[i].uncertainty.in_map()(0, 0)); };
  EXPECT_GT(sigma(kGap), 0.07);
  EXPECT_LT(sigma(kGap - 1), 0.03);
}

// A sweep each two seconds: that is how this sensor is used.
TEST_F(OdometryGapTest, SweepsThatAreAlwaysFarApartAreNoSilence) {
  Drive drive;
  drive.truth = walk(Eigen::Isometry3d(Eigen::Translation3d(kGapStep, 0.0, 0.0)), 5);
  for (size_t i = 0; i < drive.truth.size(); ++i) {
    drive.truth[i].stamp = std::chrono::seconds(1000 + 2 * i);
  }
  drive.sweeps = test::scan_all(test::make_street(100.0), drive.truth, test::Lidar{});
  const auto results = run_odometry(context(), drive.sweeps);
  for (size_t i = 1; i < results.size(); ++i) {
    EXPECT_EQ(results[i].silence, 0.0) << i;
    EXPECT_EQ(results[i].state, OdometryState::tracking) << i;
  }
}

TEST_F(OdometryGapTest, AnEmptySweepAfterALongSilenceLeavesTheNewStartToTheNext) {
  Drive drive = interrupted(std::chrono::seconds(60), Eigen::Isometry3d::Identity());
  drive.sweeps[kGap].points.clear();
  drive.sweeps[kGap].times.clear();
  drive.sweeps[kGap].rings.clear();
  const auto results = run_odometry(context(), drive.sweeps);
  EXPECT_EQ(results[kGap].state, OdometryState::coasting);
  EXPECT_EQ(results[kGap + 1].state, OdometryState::restarted);
  EXPECT_EQ(results[kGap + 2].state, OdometryState::tracking);
}

TEST_F(OdometryGapTest, InASmoothTunnelNobodyKnowsHowFarItWent) {
  test::World tunnel;
  tunnel.blocks = {{{-200.0, -6.0, 0.0}, {300.0, -3.0, 6.0}},
                   {{-200.0, 3.0, 0.0}, {300.0, 6.0, 6.0}}};
  Drive drive;
  drive.truth = walk(jump(6.0, 0.0, 0.0), 8);
  drive.sweeps = test::scan_all(tunnel, drive.truth, test::Lidar{});
  const auto results = run_odometry(context(), drive.sweeps);
  EXPECT_EQ(results[kGap].registration.status, RegistrationStatus::doubtful);
  ASSERT_TRUE(results[kGap].rejection);
  EXPECT_TRUE(std::holds_alternative<NotHeldAlong>(*results[kGap].rejection));
  EXPECT_EQ(count(results, OdometryState::restarted), 1U);
}

}  // namespace
}  // namespace adit
