// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/dense_cloud.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace adit {
namespace {

using std::chrono::milliseconds;

StampedPose pose(int ms, double x, double yaw = 0.0) {
  StampedPose stamped{.stamp = milliseconds(ms)};
  stamped.pose =
      Eigen::Translation3d(x, 0.0, 0.0) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ());
  return stamped;
}

TEST(SensorPath, MovesAtConstantVelocityBetweenItsPoses) {
  const SensorPath path({pose(100, 1.0, 0.2), pose(0, 0.0), pose(200, 3.0, 0.2)});
  const auto first = path.from(milliseconds(0));
  ASSERT_TRUE(first);
  EXPECT_TRUE(first->at(0.0).isApprox(pose(0, 0.0).pose));
  EXPECT_TRUE(first->at(0.1).isApprox(pose(0, 1.0, 0.2).pose, 1e-12));
  const Eigen::Isometry3d half = first->at(0.05);
  EXPECT_TRUE((half * half.inverse()).isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_NEAR(std::atan2(half.linear()(1, 0), half.linear()(0, 0)), 0.1, 1e-12);
}

TEST(SensorPath, TheLastPoseAndOneBeforeAGapMoveOnAsBefore) {
  const SensorPath path({pose(0, 0.0), pose(100, 1.0), pose(2000, 50.0), pose(9000, 0.0)});
  EXPECT_NEAR(path.from(milliseconds(100))->at(0.1).translation().x(), 2.0, 1e-12);
  EXPECT_NEAR(path.from(milliseconds(2000))->at(0.1).translation().x(), 50.0, 1e-12)
      << "nothing near it says how it moves";
  EXPECT_FALSE(path.from(milliseconds(50)));
  EXPECT_FALSE(SensorPath({}).from(milliseconds(0)));
}

TEST(PlacedPoints, EachReturnIsWhereItsOwnTimePutsIt) {
  const SensorPath path({pose(1000, 0.0), pose(1100, 1.0)});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Sweep sweep{.stamp = milliseconds(1000),
                    .points = {{5.0F, 0.0F, 0.0F, 7.0F},
                               {nan, 0.0F, 0.0F, 0.0F},
                               {0.0F, 0.0F, 0.0F, 0.0F},
                               {5.0F, 0.0F, 0.0F, 8.0F}},
                    .times = {0.0F, 0.01F, 0.02F, 0.05F},
                    .rings = {3, 4, 5, 6},
                    .source = {}};
  const std::vector<CloudPoint> placed = placed_points(sweep, *path.from(milliseconds(1000)));
  ASSERT_EQ(placed.size(), 2U);
  EXPECT_NEAR(placed[0].position.x(), 5.0, 1e-6);
  EXPECT_FLOAT_EQ(placed[0].intensity, 7.0F);
  EXPECT_EQ(placed[0].ring, 3);
  EXPECT_NEAR(placed[1].position.x(), 5.5, 1e-6);
  EXPECT_NEAR(seconds(placed[1].time), 1.05, 1e-6);
  EXPECT_EQ(placed[1].ring, 6);
}

}  // namespace
}  // namespace adit
