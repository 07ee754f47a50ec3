// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/registration/beam_spacing.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "adit/benchmarks/verify/synthetic_world.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

Sweep street(const test::Lidar& lidar) {
  StampedPose pose;
  pose.pose.translation() << 20.0, 0.0, 1.8;
  return test::scan(test::make_street(40.0), pose, lidar);
}

TEST(BeamSpacing, OfRingsIsTheAngleBetweenThem) {
  for (const int beams : {16, 32, 64, 128}) {
    const test::Lidar lidar{.beams = beams, .columns = 900};
    const auto spacing = measured_beam_spacing(street(lidar).points);
    ASSERT_TRUE(spacing) << beams << " beams";
    const double rings = (lidar.highest - lidar.lowest) / (beams - 1);
    EXPECT_NEAR(*spacing, rings, 0.05 * rings) << beams << " beams";
  }
}

TEST(BeamSpacing, OfAPatternThatFillsTheViewIsTheGapAtADirectionDrawnAtRandom) {
  // Gaps between directions drawn at random are exponential; half of their sum is in those longer
  // than 1.678 times their mean.
  Random random(1);
  constexpr int kReturns = 20'000;
  std::vector<Point> points;
  for (int i = 0; i < kReturns; ++i) {
    const double azimuth = random.uniform(-std::numbers::pi, std::numbers::pi);
    const double elevation = random.uniform(-0.12, 0.91);
    points.push_back({static_cast<float>(10.0 * std::cos(elevation) * std::cos(azimuth)),
                      static_cast<float>(10.0 * std::cos(elevation) * std::sin(azimuth)),
                      static_cast<float>(10.0 * std::sin(elevation)), 0.0F});
  }
  const double expected = 1.678 * 1.03 * 360.0 / kReturns;
  EXPECT_NEAR(measured_beam_spacing(points).value_or(0.0), expected, 0.05 * expected);
}

TEST(BeamSpacing, NeedsAThousandReturns) {
  std::vector<Point> points = street({}).points;
  points.resize(1500);
  std::vector<Point> returns;
  for (const Point& p : points) {
    if (std::hypot(p.x, p.y) > 0.1F) {
      returns.push_back(p);
    }
  }
  ASSERT_GE(returns.size(), 1000U);
  EXPECT_TRUE(measured_beam_spacing(returns));
  for (size_t i = 999; i < returns.size(); ++i) {
    returns[i] = i % 2 == 0 ? Point{} : Point{.x = std::numeric_limits<float>::quiet_NaN()};
  }
  EXPECT_FALSE(measured_beam_spacing(returns)) << "neither (0, 0, 0) nor NaN is a return";
  EXPECT_FALSE(measured_beam_spacing({}));
}

TEST(BeamSpacing, StaysWithinWhatSensorsHave) {
  const std::vector<Point> same(2000, Point{.x = 5.0F, .y = 0.0F, .z = 1.0F});
  EXPECT_EQ(measured_beam_spacing(same), 0.002);
  std::vector<Point> two_rings;
  for (int i = 0; i < 2000; ++i) {
    const double azimuth = 2.0 * std::numbers::pi * i / 2000.0;
    two_rings.push_back({static_cast<float>(5.0 * std::cos(azimuth)),
                         static_cast<float>(5.0 * std::sin(azimuth)), i % 2 == 0 ? 2.0F : -2.0F});
  }
  EXPECT_EQ(measured_beam_spacing(two_rings), 0.2);
}

std::vector<Point> at_range(float range, int count) {
  return std::vector<Point>(static_cast<size_t>(count), Point{range, 0.0F, 0.0F, 0.0F});
}

TEST(VoxelSize, FollowsWhereMostPointsAreWithinItsBounds) {
  EXPECT_NEAR(measured_voxel_size(at_range(6.0F, 2000)).value_or(0.0), 0.1, 1e-6);
  EXPECT_EQ(measured_voxel_size(at_range(1.0F, 2000)), 0.05);
  EXPECT_EQ(measured_voxel_size(at_range(40.0F, 2000)), 0.25);
  std::vector<Point> mixed = at_range(0.0F, 5000);  // no returns
  for (const Point& p : at_range(3.0F, 1500)) {
    mixed.push_back(p);
  }
  for (const Point& p : at_range(12.0F, 300)) {
    mixed.push_back(p);
  }
  EXPECT_NEAR(measured_voxel_size(mixed).value_or(0.0), 0.2, 1e-6) << "a sixth is far";
}

TEST(VoxelSize, NeedsAThousandReturns) {
  EXPECT_EQ(measured_voxel_size(at_range(3.0F, 999)), std::nullopt);
}

}  // namespace
}  // namespace adit
