// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Walls in slices whose walls are known.
#include "adit/tools/plans/wall_lines.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tools/plans/wall_corners.hpp"

namespace adit {
namespace {

using Eigen::Vector2d;

constexpr double kNoise = 0.01;    // m, of a good lidar
constexpr double kSpacing = 0.01;  // m, between points along a wall

/// Points on a wall, whose left is seen.
void add_wall(SliceCells& cells, const Vector2d& from, const Vector2d& to, std::mt19937& random) {
  std::normal_distribution<double> noise(0.0, kNoise);
  const Vector2d along = (to - from).normalized();
  const Vector2d normal(-along.y(), along.x());
  for (double at = 0.5 * kSpacing; at < (to - from).norm(); at += kSpacing) {
    cells.add(from + at * along + noise(random) * normal, normal);
  }
}

/// A room of 6 x 4 m, seen from inside.
SliceCells room(const Vector2d& corner) {
  SliceCells cells;
  std::mt19937 random(3);
  const std::vector<Vector2d> corners = {{0, 0}, {6, 0}, {6, 4}, {0, 4}};
  for (std::size_t i = 0; i < 4; ++i) {
    add_wall(cells, corner + corners[i], corner + corners[(i + 1) % 4], random);
  }
  return cells;
}

/// The wall nearest to a place.
const WallSegment& wall_at(const WallLines& lines, const Vector2d& place) {
  return *std::ranges::min_element(lines.walls, {},
                                   [&](const WallSegment& wall) { return distance(wall, place); });
}

TEST(WallLines, ARoomIsFourLinesThatMeetInItsCorners) {
  const WallLines lines = find_walls(room({0.0, 0.0}));
  ASSERT_EQ(lines.walls.size(), 4U);
  EXPECT_TRUE(lines.rest.empty());
  EXPECT_NEAR(lines.noise, kNoise, 0.003);
  for (const Vector2d& corner : {Vector2d(0, 0), Vector2d(6, 0), Vector2d(6, 4), Vector2d(0, 4)}) {
    EXPECT_EQ(std::ranges::count_if(lines.walls,
                                    [&](const WallSegment& wall) {
                                      return (wall.from - corner).norm() < 0.004 ||
                                             (wall.to - corner).norm() < 0.004;
                                    }),
              2);
  }
  for (const WallSegment& wall : lines.walls) {
    const Vector2d way = wall.to - wall.from;
    const Vector2d inwards = Vector2d(3, 2) - wall.from;
    EXPECT_GT(way.x() * inwards.y() - way.y() * inwards.x(), 0.0) << "the room is to the left";
    EXPECT_NEAR(wall.spread, kNoise, 0.003);
  }
}

TEST(WallLines, FarFromTheOriginTheyAreTheSame) {
  const WallLines near = find_walls(room({0.0, 0.0}));
  const Vector2d utm(676'400.0, 4'612'850.0);
  const WallLines far = find_walls(room(utm));
  ASSERT_EQ(far.walls.size(), near.walls.size());
  for (const WallSegment& wall : far.walls) {
    const Vector2d middle = 0.5 * (wall.from + wall.to) - utm;
    EXPECT_LT(distance(wall_at(near, middle), middle), 1e-6);
  }
}

TEST(WallLines, BothFacesOfAThinWallAreLines) {
  SliceCells cells;
  std::mt19937 random(4);
  add_wall(cells, {0.0, 0.0}, {5.0, 0.0}, random);
  add_wall(cells, {5.0, -0.08}, {0.0, -0.08}, random);
  const WallLines lines = find_walls(cells);
  ASSERT_EQ(lines.walls.size(), 2U);
  EXPECT_LT(distance(wall_at(lines, {2.5, 0.0}), {2.5, 0.0}), 0.002);
  EXPECT_LT(distance(wall_at(lines, {2.5, -0.08}), {2.5, -0.08}), 0.002);
}

TEST(WallLines, ADoorStaysOpenAndASmallGapDoesNot) {
  for (const auto& [gap, walls] : {std::pair(0.8, 2U), std::pair(0.2, 1U)}) {
    SliceCells cells;
    std::mt19937 random(5);
    add_wall(cells, {0.0, 1.0}, {3.0, 1.0}, random);
    add_wall(cells, {3.0 + gap, 1.0}, {6.0, 1.0}, random);
    const WallLines lines = find_walls(cells);
    ASSERT_EQ(lines.walls.size(), walls) << gap;
    const WallSegment& first = wall_at(lines, {0.1, 1.0});
    EXPECT_NEAR(std::max(first.from.x(), first.to.x()), walls == 2U ? 3.0 : 6.0, 0.03);
  }
}

TEST(WallLines, ASlantedWallIsOneLine) {
  SliceCells cells;
  std::mt19937 random(6);
  add_wall(cells, {0.0, 0.0}, {12.0, 4.7}, random);
  const WallLines lines = find_walls(cells);
  ASSERT_EQ(lines.walls.size(), 1U);
  EXPECT_NEAR((lines.walls[0].to - lines.walls[0].from).norm(), std::hypot(12.0, 4.7), 0.05);
  EXPECT_LT(distance(lines.walls[0], {6.0, 2.35}), 0.002);
}

TEST(WallLines, WhatIsNoWallStaysPoints) {
  SliceCells cells;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> within(-0.5, 0.5);
  for (int i = 0; i < 2000; ++i) {  // a bush: surfaces of every direction
    cells.add({within(random), within(random)}, {within(random), within(random)});
  }
  cells.add({7.0, 7.0}, Vector2d::Zero());  // and one without any
  const WallLines lines = find_walls(cells);
  double length = 0.0;
  for (const WallSegment& wall : lines.walls) {
    length += (wall.to - wall.from).norm();
  }
  EXPECT_LT(length, 2.0);
  EXPECT_GT(lines.rest.size(), 100U);
  EXPECT_TRUE(std::ranges::any_of(lines.rest, [](const Vector2d& point) {
    return (point - Vector2d(7.025, 7.025)).norm() < 1e-9;
  }));
  EXPECT_TRUE(find_walls({}).walls.empty());
}

TEST(WallLines, ARoundPillarIsMadeOfShortLinesOnIt) {
  SliceCells cells;
  for (int i = 0; i < 2000; ++i) {
    const double turn = 2.0 * 3.14159265358979 * i / 2000.0;
    const Vector2d out(std::cos(turn), std::sin(turn));
    cells.add(3.0 * out, -out);
  }
  const WallLines lines = find_walls(cells);
  EXPECT_GT(lines.walls.size(), 8U);
  for (const WallSegment& wall : lines.walls) {
    for (const double share : {0.0, 0.5, 1.0}) {
      EXPECT_NEAR((wall.from + share * (wall.to - wall.from)).norm(), 3.0, 0.05);
    }
  }
}

}  // namespace
}  // namespace adit
