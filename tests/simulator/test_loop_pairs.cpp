// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/loop_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "adit/tools/simulator/mesh.hpp"

namespace adit {
namespace {

constexpr double kPi = std::numbers::pi;

/// Level, all around.
std::vector<Eigen::Vector3d> around() {
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < 180; ++i) {
    const double angle = 2.0 * kPi * i / 180.0;
    directions.emplace_back(std::cos(angle), std::sin(angle), 0.0);
  }
  return directions;
}

/// A hall of 40 x 10 m, with a wall along its middle where `divided`.
RayScene hall(bool divided) {
  Mesh mesh;
  const auto wall = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = 0.5 * (low + high);
    add_box(mesh, pose, 0.5 * (high - low), Material::concrete);
  };
  wall({-20, -5.2, -2}, {20, -5, 2});
  wall({-20, 5, -2}, {20, 5.2, 2});
  wall({-20.2, -5, -2}, {-20, 5, 2});
  wall({20, -5, -2}, {20.2, 5, 2});
  if (divided) {
    wall({-20, -0.1, -2}, {20, 0.1, 2});
  }
  return RayScene(mesh);
}

/// Along the hall on one side, and back on the other, 1 m/s.
Eigen::Isometry3d there_and_back(double time) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = time < 30.0 ? Eigen::Vector3d(-15.0 + time, -2.5, 0.0)
                                   : Eigen::Vector3d(15.0 - (time - 30.0), 2.5, 0.0);
  if (time >= 30.0) {
    pose.linear() = Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  }
  return pose;
}

TEST(LoopPairs, ComingBackSeesTheSameWhateverTheHeading) {
  const RayScene still = hall(false);
  const auto loops = find_loops(there_and_back, 60.0, around(), still, {});
  ASSERT_FALSE(loops.empty());
  const auto opposite = std::ranges::find_if(loops, [](const LoopPair& loop) {
    return std::abs(loop.time_a - 10.0) < 0.6 && std::abs(loop.time_b - 50.0) < 0.6;
  });
  ASSERT_NE(opposite, loops.end());
  EXPECT_NEAR(opposite->distance, 5.0, 0.3);
  EXPECT_NEAR(opposite->angle, kPi, 1e-6);
  EXPECT_GT(opposite->overlap, 0.95) << "an empty hall is seen as a whole from everywhere";
  for (const LoopPair& loop : loops) {
    EXPECT_LT(loop.time_a, loop.time_b);
    EXPECT_GE(loop.overlap, 0.3);
    EXPECT_LE(loop.distance, 20.0);
  }
}

TEST(LoopPairs, AWallBetweenHidesAll) {
  const RayScene still = hall(true);
  EXPECT_TRUE(find_loops(there_and_back, 60.0, around(), still, {}).empty());
  EXPECT_FALSE(find_loops(there_and_back, 60.0, around(), still, {.detour = 0.0}).empty())
      << "straight on along one side all is in sight";
}

TEST(LoopPairs, WhatIsOutOfRangeIsNotSeen) {
  const RayScene still = hall(false);
  const auto all = find_loops(there_and_back, 60.0, around(), still, {});
  const auto near = find_loops(there_and_back, 60.0, around(), still, {.range = 4.0});
  EXPECT_LT(near.size(), all.size());
}

}  // namespace
}  // namespace adit
