// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/gnss/odometry_track.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

/// After so many seconds of a steady turn at 5 m/s.
StampedPose turning(double t) {
  Vector6d twist;
  twist << 5.0, 0.0, 0.0, 0.0, 0.0, 0.4;
  return {.stamp = nanoseconds(t), .pose = se3_exp(t * twist)};
}

TEST(OdometryTrack, InterpolatesAtAConstantTwist) {
  OdometryTrack track;
  for (const double t : {0.0, 0.1, 0.2, 0.3}) {
    track.add(turning(t), false);
  }
  const auto motion = track.at(nanoseconds(0.16));
  ASSERT_TRUE(motion);
  EXPECT_TRUE(motion->T_odom_lidar.isApprox(turning(0.16).pose, 1e-9));
  EXPECT_NEAR(motion->twist(0), 5.0, 1e-6);
  EXPECT_NEAR(motion->twist(5), 0.4, 1e-6);
  const auto way = track.way(nanoseconds(0.25), nanoseconds(0.05));
  ASSERT_TRUE(way);
  EXPECT_TRUE(way->isApprox(turning(-0.2).pose, 1e-9));
  EXPECT_FALSE(track.at(nanoseconds(-0.1)));
  EXPECT_FALSE(track.at(nanoseconds(0.4)));
}

TEST(OdometryTrack, SaysNothingOfPausesAndAcrossRestarts) {
  OdometryTrack track;
  EXPECT_FALSE(track.at(nanoseconds(0.0)));
  for (const double t : {0.0, 0.1}) {
    track.add(turning(t), false);
  }
  track.add(turning(0.2), true);
  track.add(turning(0.3), false);
  track.add(turning(1.5), false);
  EXPECT_FALSE(track.at(nanoseconds(0.15)));
  EXPECT_TRUE(track.at(nanoseconds(0.25)));
  EXPECT_FALSE(track.way(nanoseconds(0.05), nanoseconds(0.25)));
  EXPECT_FALSE(track.at(nanoseconds(0.9)));
}

}  // namespace
}  // namespace adit
