// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Storeys of paths whose floors are known.
#include "adit/tools/plans/storeys.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace adit {
namespace {

using Eigen::Vector3d;

/// Steps of half a metre from one place of the floor to another, the sensor 0.8 m above it.
void walk(std::vector<FloorStep>& steps, const Vector3d& from, const Vector3d& to) {
  const double length = (to - from).norm();
  for (double at = 0.0; at < length; at += 0.5) {
    const Vector3d floor = from + at / length * (to - from);
    steps.push_back({.sensor = floor + Vector3d(0.0, 0.0, 0.8)});
  }
}

/// Two floors, 3.4 m apart, with a staircase between them.
std::vector<FloorStep> house() {
  std::vector<FloorStep> steps;
  walk(steps, {0, 0, 0}, {20, 0, 0});
  walk(steps, {20, 0, 0}, {24, 0, 1.7});
  walk(steps, {24, 0, 1.7}, {24, 6, 1.7});  // a landing, longer than 5 m
  walk(steps, {24, 6, 1.7}, {20, 2, 3.4});
  walk(steps, {20, 2, 3.4}, {5, 2, 3.4});
  for (std::size_t i = 0; i < 30; ++i) {
    steps[i].seen_floor = 0.0;
  }
  steps[60].seen_floor = 0.0;  // a staircase, from where the lower floor is seen
  return steps;
}

TEST(Storeys, AreWhereThePathGoes) {
  const std::vector<Storey> storeys = find_storeys(floors_under(house()));
  ASSERT_EQ(storeys.size(), 2U);
  EXPECT_NEAR(storeys[0].floor, 0.0, 0.01);
  EXPECT_NEAR(storeys[1].floor, 3.4, 0.01);
  EXPECT_NEAR(storeys[0].length, 20.0 + 4.0 * 1.1 / 1.7, 1.0);
}

TEST(Storeys, AFloorThatSlopesIsFollowed) {
  std::vector<FloorStep> steps;
  walk(steps, {0, 0, 0}, {30, 0, 0.9});
  for (FloorStep& step : steps) {
    step.seen_floor = step.sensor.z() - 0.8;
  }
  const std::vector<Storey> storeys = find_storeys(floors_under(steps));
  ASSERT_EQ(storeys.size(), 1U);
  StoreyFloor floor(storeys[0].path);
  EXPECT_NEAR(floor.at({0.2, 3.0}), 0.0, 0.03);
  EXPECT_NEAR(floor.at({29.8, -3.0}), 0.9, 0.03);
}

TEST(Storeys, WithoutGroundOrPathThereAreNone) {
  std::vector<FloorStep> steps;
  walk(steps, {0, 0, 0}, {20, 0, 0});
  EXPECT_TRUE(floors_under(steps).empty()) << "nobody saw ground";
  std::vector<FloorStep> standing(100, {.sensor = {1.0, 2.0, 0.8}, .seen_floor = 0.0});
  EXPECT_TRUE(find_storeys(floors_under(standing)).empty());
  EXPECT_TRUE(find_storeys({}).empty());
}

TEST(Storeys, GroundIsBelowAndLevel) {
  const MapKeyframe keyframe;
  const Vector3d sensor(0.0, 0.0, 0.8);
  std::vector<PlanPoint> points;
  for (int i = 0; i < 40; ++i) {
    points.push_back({.position = {3.0, 0.1 * i, 0.01}, .normal = Vector3d::UnitZ()});
    points.push_back({.position = {4.0, 0.1 * i, 0.5}, .normal = Vector3d::UnitX()});    // a wall
    points.push_back({.position = {3.0, 0.1 * i, 2.9}, .normal = -Vector3d::UnitZ()});   // ceiling
    points.push_back({.position = {30.0, 0.1 * i, -5.0}, .normal = Vector3d::UnitZ()});  // far
  }
  EXPECT_NEAR(floor_step(keyframe, sensor, points).seen_floor.value(), 0.01, 1e-9);
  points.resize(40);
  EXPECT_FALSE(floor_step(keyframe, sensor, points).seen_floor.has_value());
}

}  // namespace
}  // namespace adit
