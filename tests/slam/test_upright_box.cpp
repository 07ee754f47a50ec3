// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/core/upright_box.hpp"

#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

namespace adit {
namespace {

using Eigen::Vector3d;

TEST(UprightBox, OfATurnedBoxItIsThatBox) {
  for (const double angle : {0.0, 0.3, 1.2, 2.0, 3.0}) {
    const Eigen::AngleAxisd turn(angle, Vector3d::UnitZ());
    std::vector<Vector3d> corners;
    for (int i = 0; i < 8; ++i) {
      const Vector3d corner((i & 1) != 0 ? 2.0 : -2.0, (i & 2) != 0 ? 0.5 : -0.5,
                            (i & 4) != 0 ? 1.5 : 0.0);
      corners.emplace_back(turn * corner + Vector3d(10.0, -3.0, 0.0));
    }
    const UprightBox box = upright_box(corners);
    EXPECT_NEAR(box.centre.x(), 10.0, 1e-9);
    EXPECT_NEAR(box.centre.z(), 0.75, 1e-9);
    EXPECT_NEAR(box.size.x(), 4.0, 0.05) << angle;
    EXPECT_NEAR(box.size.y(), 1.0, 0.05) << angle;
    EXPECT_NEAR(box.volume(), 6.0, 0.3);
    EXPECT_GE(box.along.x(), 0.0);
    EXPECT_NEAR(std::abs(box.along.dot(Eigen::Vector2d(std::cos(angle), std::sin(angle)))), 1.0,
                1e-3);
    for (const Vector3d& corner : corners) {
      EXPECT_TRUE(box.contains(corner, 1e-6));
    }
    EXPECT_FALSE(box.contains(Vector3d(10.0, -3.0, 1.6)));
    EXPECT_TRUE(box.contains(Vector3d(10.0, -3.0, 1.6), 0.2));
  }
}

TEST(UprightBox, OfNoPointsItIsEmptyAndOfOneItIsThatPoint) {
  EXPECT_EQ(upright_box({}).volume(), 0.0);
  const std::vector<Vector3d> one{Vector3d(1.0, 2.0, 3.0)};
  const UprightBox box = upright_box(one);
  EXPECT_EQ(box.centre, one.front());
  EXPECT_EQ(box.size, Vector3d::Zero());
  EXPECT_EQ(box.footprint()[2], Eigen::Vector2d(1.0, 2.0));
}

}  // namespace
}  // namespace adit
