// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Ground and contour lines of surfaces that are known.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tools/plans/contour_lines.hpp"
#include "adit/tools/plans/ground_surface.hpp"

namespace adit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kCell = 0.25;  // m

/// A cone of 2 m in height and 8 m in radius, on flat ground.
double cone(double x, double y) {
  return std::max(0.0, 2.0 - 0.25 * std::hypot(x, y));
}

GroundHeights ground_of_cone() {
  GroundHeights ground(kCell);
  for (int64_t y = -48; y < 48; ++y) {
    for (int64_t x = -48; x < 48; ++x) {
      const Vector2d p = ground.middle({y, x});
      ground.set({y, x}, cone(p.x(), p.y()));
    }
  }
  return ground;
}

TEST(ContourLines, OfAConeAreCircles) {
  const std::vector<ContourLine> lines = contour_lines(ground_of_cone(), 0.5);
  ASSERT_EQ(lines.size(), 3U);  // 0 is touched from above alone, and 2 by the tip
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(lines[i].closed);
    EXPECT_NEAR(lines[i].height, 0.5 * static_cast<double>(i + 1), 1e-12);
    for (const Vector2d& p : lines[i].places) {
      EXPECT_NEAR(p.norm(), 8.0 - 4.0 * lines[i].height, 0.02);
    }
    EXPECT_GT(lines[i].places.size(), 8.0 * (8.0 - 4.0 * lines[i].height));
  }
}

TEST(ContourLines, OfASlopeAreStraightAndOpen) {
  GroundHeights ground(kCell);
  for (int64_t y = 0; y < 20; ++y) {
    for (int64_t x = 0; x < 20; ++x) {
      ground.set({y, x}, 0.3 * ground.middle({y, x}).x() - 0.4);
    }
  }
  const std::vector<ContourLine> lines = contour_lines(ground, 0.25);
  ASSERT_FALSE(lines.empty());
  for (const ContourLine& line : lines) {
    EXPECT_FALSE(line.closed);
    EXPECT_EQ(line.places.size(), 20U);
    for (const Vector2d& p : line.places) {
      EXPECT_NEAR(0.3 * p.x() - 0.4, line.height, 1e-9);
    }
  }
  EXPECT_LT(lines.front().height, 0.0);
}

TEST(ContourLines, EndWhereNothingIsKnownAndPassASaddle) {
  GroundHeights hole(kCell);
  for (int64_t y = 0; y < 20; ++y) {
    for (int64_t x = 0; x < 20; ++x) {
      if (y < 8 || y > 11) {
        hole.set({y, x}, 0.3 * hole.middle({y, x}).x());
      }
    }
  }
  EXPECT_EQ(contour_lines(hole, 0.9).size(), 2U);
  GroundHeights saddle(1.0);
  for (int64_t i = 0; i < 4; ++i) {
    saddle.set({i / 2, i % 2}, i == 0 || i == 3 ? 1.0 : 0.2);
  }
  const std::vector<ContourLine> lines = contour_lines(saddle, 0.5);
  ASSERT_EQ(lines.size(), 2U);
  for (const ContourLine& line : lines) {  // the middle, 0.6, is high: the low corners are cut off
    const Vector2d middle = 0.5 * (line.places.front() + line.places.back());
    EXPECT_LT(std::min((middle - Vector2d(1.5, 0.5)).norm(), (middle - Vector2d(0.5, 1.5)).norm()),
              0.4);
  }
}

TEST(Ground, IsReachedFromThePathAndNoTable) {
  GroundSearch search(kCell);
  std::vector<PlanPoint> points;
  for (double x = -9.95; x < 10.0; x += 0.1) {
    for (double y = -9.95; y < 10.0; y += 0.1) {
      const bool table = std::abs(x - 6.0) < 0.6 && std::abs(y - 6.0) < 0.4;
      points.push_back(
          {.position = {x, y, table ? 0.75 : cone(x, y)}, .normal = Vector3d::UnitZ()});
      points.push_back({.position = {x, y, 3.0}, .normal = -Vector3d::UnitZ()});       // a ceiling
      points.push_back({.position = {x, y, 2.6}, .normal = Vector3d(1.0, 0.0, 0.2)});  // leaves
    }
  }
  search.add(points);
  const std::vector<FloorStep> steps(1, {.sensor = {-9.0, -9.0, 0.8}, .floor = 0.0});
  const GroundLevels ground = search.levels_from(steps);
  const GroundHeights grid(0.25);
  EXPECT_FALSE(ground.contains(grid.index_of({6.0, 6.0})));
  std::size_t known = 0;
  for (const auto& [cell, heights] : ground) {
    const Vector2d p = grid.middle(cell);
    ASSERT_EQ(heights.size(), 1U);
    EXPECT_NEAR(heights.front(), cone(p.x(), p.y()), 0.03);
    ++known;
  }
  EXPECT_GT(known, 6300U);  // of 6400, less those of the table
  EXPECT_LT(known, 6400U);
  EXPECT_TRUE(search.levels_from({}).empty());
}

TEST(Ground, SmoothingKeepsASlope) {
  GroundHeights rough(kCell);
  for (int64_t y = 0; y < 20; ++y) {
    for (int64_t x = 0; x < 20; ++x) {
      rough.set({y, x}, 0.1 * static_cast<double>(x) + ((x + y) % 2 == 0 ? 0.05 : -0.05));
    }
  }
  const GroundHeights smooth = smoothed(rough);
  EXPECT_NEAR(*smooth.at({10, 10}), 1.0, 0.01);
  EXPECT_EQ(smooth.cells().size(), rough.cells().size());
}

}  // namespace
}  // namespace adit
