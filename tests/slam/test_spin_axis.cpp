// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/registration/spin_axis.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "adit/benchmarks/verify/synthetic_world.hpp"
#include "adit/slam/registration/beam_spacing.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

std::vector<Point> street(const test::Lidar& lidar) {
  StampedPose pose;
  pose.pose.translation() << 20.0, 0.0, 1.8;
  return test::scan(test::make_street(40.0), pose, lidar).points;
}

std::vector<Point> turned(std::vector<Point> points, const Eigen::Matrix3d& R) {
  for (Point& p : points) {
    const Eigen::Vector3f q = (R * Eigen::Vector3d(p.x, p.y, p.z)).cast<float>();
    p = {.x = q.x(), .y = q.y(), .z = q.z(), .intensity = p.intensity};
  }
  return points;
}

/// Axes of drivers, sensors on their side, upside down and tilted.
std::vector<Eigen::Matrix3d> mountings() {
  const auto about = [](double angle, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  };
  constexpr double kQuarter = std::numbers::pi / 2.0;
  return {about(kQuarter, {1.0, 0.0, 0.0}),       about(-kQuarter, {0.0, 1.0, 0.0}),
          about(2.0 * kQuarter, {1.0, 0.0, 0.0}), about(kQuarter, {0.0, 0.0, 1.0}),
          about(0.5 * kQuarter, {1.0, 1.0, 0.0}), about(1.1, {0.3, -1.0, 0.5})};
}

TEST(SpinAxis, OfASensorThatStandsUprightIsExactlyItsZ) {
  for (const int beams : {16, 32, 64, 128}) {
    for (const int columns : {512, 900, 1800}) {
      EXPECT_EQ(spin_axis(street({.beams = beams, .columns = columns})), Eigen::Vector3d::UnitZ())
          << beams << " beams, " << columns << " columns";
    }
  }
}

TEST(SpinAxis, IsFoundWhateverAxesTheCloudIsIn) {
  for (const int beams : {16, 64}) {
    for (const int columns : {512, 1800}) {
      const std::vector<Point> upright = street({.beams = beams, .columns = columns});
      const double spacing = measured_beam_spacing(upright).value();
      for (const Eigen::Matrix3d& R : mountings()) {
        const std::vector<Point> cloud = turned(upright, R);
        EXPECT_GT(std::abs(spin_axis(cloud).dot(R.col(2))), std::cos(0.05)) << R;
        EXPECT_NEAR(measured_beam_spacing(cloud).value_or(0.0), spacing, 0.05 * spacing)
            << beams << " beams, " << columns << " columns\n"
            << R;
      }
    }
  }
}

// Steps along the equator are steps along meridians of every axis across it.
TEST(SpinAxis, OfBeamsThatAreAllNearTheEquatorIsFoundToo) {
  const test::Lidar flat{.beams = 8, .columns = 1800, .lowest = -0.03, .highest = 0.03};
  const std::vector<Point> upright = street(flat);
  ASSERT_GT(upright.size(), 1000U);
  EXPECT_EQ(spin_axis(upright), Eigen::Vector3d::UnitZ());
  for (const Eigen::Matrix3d& R : mountings()) {
    EXPECT_GT(std::abs(spin_axis(turned(upright, R)).dot(R.col(2))), std::cos(0.1)) << R;
  }
}

TEST(SpinAxis, OfAPatternWithoutOneAndOfFewReturnsIsZ) {
  Random random(1);
  std::vector<Point> points;
  for (int i = 0; i < 20'000; ++i) {
    const Eigen::Vector3d p(10.0, random.uniform(-4.0, 4.0), random.uniform(-4.0, 4.0));
    points.push_back({.x = static_cast<float>(p.x()),
                      .y = static_cast<float>(p.y()),
                      .z = static_cast<float>(p.z())});
  }
  EXPECT_EQ(spin_axis(points), Eigen::Vector3d::UnitZ());
  points.resize(500);
  EXPECT_EQ(spin_axis(points), Eigen::Vector3d::UnitZ());
  EXPECT_EQ(spin_axis({}), Eigen::Vector3d::UnitZ());
  EXPECT_EQ(spin_axis(std::vector<Point>(5000, Point{.x = 5.0F, .z = 1.0F})),
            Eigen::Vector3d::UnitZ());
}

}  // namespace
}  // namespace adit
