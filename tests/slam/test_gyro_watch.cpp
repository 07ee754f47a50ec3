// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/gyro_watch.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"

namespace adit {
namespace {

/// The sweeps say that it is this late (s), and mounted turned about z by so much (rad).
GyroCheck check(double late, double turned) {
  GyroCheck result{.turns = 30};
  result.comparison.emplace();
  result.comparison->offset = late;
  result.comparison->offset_sigma = 0.001;
  result.comparison->R_range_gyro = so3_exp({0.0, 0.0, turned});
  result.comparison->mounting_sigma = {0.001, 0.001, 0.001};
  return result;
}

constexpr CorrectionBounds kBoth{
    .clock = true, .mounting = true, .least_clock = 0.008, .sigmas = 3.0};

TEST(Correction, OfAClockBeyondItsBounds) {
  const SensorFrame frame{.T_body_lidar = Eigen::Isometry3d::Identity(), .clock_offset = 0.02};
  EXPECT_FALSE(correction(check(0.0309, 0.0), frame, kBoth));
  const auto done = correction(check(0.0311, 0.0), frame, kBoth);
  ASSERT_TRUE(done);
  EXPECT_EQ(done->frame.clock_offset, 0.0311);
  EXPECT_EQ(done->what.clock, 0.0311);
  EXPECT_FALSE(done->what.turned);
  EXPECT_TRUE(done->frame.T_body_lidar.isApprox(frame.T_body_lidar));
  EXPECT_FALSE(correction(check(0.0311, 0.0), frame, {.mounting = true, .sigmas = 3.0}))
      << "it may not be";
}

TEST(Correction, OfAMountingBeyondItsBoundsKeepsWhereItStands) {
  SensorFrame frame;
  frame.T_body_lidar.translation() << 0.1, 0.2, 0.3;
  EXPECT_FALSE(correction(check(0.0, 0.0129), frame, kBoth));
  const auto done = correction(check(0.0, 0.0131), frame, kBoth);
  ASSERT_TRUE(done);
  EXPECT_FALSE(done->what.clock);
  ASSERT_TRUE(done->what.turned);
  EXPECT_NEAR(*done->what.turned, 0.0131, 1e-9);
  const Eigen::Isometry3d T_lidar_body = done->frame.T_body_lidar.inverse();
  EXPECT_TRUE(T_lidar_body.linear().isApprox(so3_exp({0.0, 0.0, 0.0131})));
  EXPECT_TRUE(T_lidar_body.translation().isApprox(Eigen::Vector3d(-0.1, -0.2, -0.3)));
  EXPECT_FALSE(correction(check(0.0, 0.0131), frame, {.clock = true, .sigmas = 3.0}));
}

TEST(Correction, LeavesAnAxisThatTheMotionHides) {
  GyroCheck hidden = check(0.0, 0.05);
  hidden.comparison->mounting_sigma.z() = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(correction(hidden, {}, kBoth));
}

// What seems to be off about two axes is in wrong axes, where the third is far off and hidden.
TEST(Correction, OfAMountingIsKnownWhereNoAxisHidesMuch) {
  RotationComparison found{.misalignment = 0.3, .mounting_sigma = {0.01, 0.01, 0.01}};
  EXPECT_TRUE(tells_mounting(found));
  found.misalignment = 1.6;
  EXPECT_TRUE(tells_mounting(found));
  found.mounting_sigma.z() = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(tells_mounting(found));
  found.misalignment = 0.3;
  EXPECT_TRUE(tells_mounting(found));
  found.hidden_turn = 1.2;
  EXPECT_FALSE(tells_mounting(found));
}

TEST(GyroWatch, AnAccusedSensorWaitsForFiftySweeps) {
  GyroWatch watch({}, 0.0);
  EXPECT_FALSE(watch.is_pending());
  watch.accuse();
  for (int i = 0; i < 50; ++i) {
    EXPECT_TRUE(watch.is_pending()) << i;
    watch.note_sweep();
  }
  EXPECT_FALSE(watch.is_pending());
}

TEST(GyroWatch, WithoutACorrectionNothingIsOnTrial) {
  GyroWatch watch({}, 0.0);
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(watch.note_prediction(false)) << i;
  }
}

}  // namespace
}  // namespace adit
