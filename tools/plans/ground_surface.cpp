// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/plans/ground_surface.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <set>
#include <utility>
#include <vector>

namespace adit {
namespace {

// Crushed rock lies at 45 degrees at most; sand and earth lie flatter.
constexpr double kSteepest = 1.0;
constexpr double kLevelSurface = 0.7;  // of a normal's z: 45 degrees
constexpr double kLevelHeight = 0.25;  // m: surfaces that are closer to each other are one
// m, of a step besides the slope: kerbs, rails, and noise.
constexpr double kLeastStep = 0.1;
// Cells without points that a step may cross. It may rise no more than to the next cell: what is
// hidden is no cliff.
constexpr int64_t kJump = 3;
constexpr double kUnderPath = 0.5;  // m, of the ground from the floor under the sensor

}  // namespace

std::optional<double> GroundHeights::at(const Index& cell) const {
  const auto found = heights_.find(cell);
  return found == heights_.end() ? std::nullopt : std::optional(found->second);
}

Eigen::Vector2d GroundHeights::middle(const Index& cell) const {
  return size_ *
         Eigen::Vector2d(static_cast<double>(cell[1]) + 0.5, static_cast<double>(cell[0]) + 0.5);
}

GroundHeights::Index GroundHeights::index_of(const Eigen::Vector2d& place) const {
  return {static_cast<int64_t>(std::floor(place.y() / size_)),
          static_cast<int64_t>(std::floor(place.x() / size_))};
}

void GroundSearch::add(std::span<const PlanPoint> points) {
  const GroundHeights grid(size_);
  for (const PlanPoint& point : points) {
    if (point.normal.z() > kLevelSurface) {
      const GroundHeights::Index cell = grid.index_of(point.position.head<2>());
      const double z = point.position.z();
      Level& level =
          levels_[{cell[0], cell[1], static_cast<int64_t>(std::floor(z / kLevelHeight))}];
      level.sum += z;
      level.points += 1.0;
    }
  }
}

std::vector<double> GroundSearch::surfaces(const GroundHeights::Index& cell) const {
  std::vector<double> heights;
  Level open;
  const auto close = [&] {
    if (open.points > 0.0) {
      heights.push_back(open.sum / open.points);
    }
    open = {};
  };
  auto at = levels_.lower_bound({cell[0], cell[1], INT64_MIN});
  for (; at != levels_.end() && at->first[0] == cell[0] && at->first[1] == cell[1]; ++at) {
    const Level& level = at->second;
    // A surface on the border of two levels is in both.
    if (open.points > 0.0 && level.sum / level.points - open.sum / open.points > kLevelHeight) {
      close();
    }
    open.sum += level.sum;
    open.points += level.points;
  }
  close();
  return heights;
}

GroundHeights GroundSearch::reached_from(std::span<const FloorStep> steps) const {
  GroundHeights ground(size_);
  std::deque<GroundHeights::Index> waiting;
  // Whether there is anything in that cell; takes what is near enough to a height.
  const auto take = [&](const GroundHeights::Index& cell, double from, double most) {
    const std::vector<double> heights = surfaces(cell);
    const auto nearest = std::ranges::min_element(
        heights, {}, [&](double height) { return std::abs(height - from); });
    if (nearest != heights.end() && std::abs(*nearest - from) <= most && !ground.at(cell)) {
      ground.set(cell, *nearest);
      waiting.push_back(cell);
    }
    return !heights.empty();
  };
  const auto reach = static_cast<int64_t>(std::ceil(1.0 / size_));
  for (const FloorStep& step :
       steps) {  // the ground right under the sensor is hidden by its carrier
    const GroundHeights::Index under = ground.index_of(step.sensor.head<2>());
    for (int64_t y = under[0] - reach; y <= under[0] + reach; ++y) {
      for (int64_t x = under[1] - reach; x <= under[1] + reach; ++x) {
        take({y, x}, step.floor, kUnderPath);
      }
    }
  }
  while (!waiting.empty()) {
    const GroundHeights::Index at = waiting.front();
    waiting.pop_front();
    const double height = *ground.at(at);
    for (int64_t dy = -1; dy <= 1; ++dy) {
      for (int64_t dx = -1; dx <= 1; ++dx) {
        const double distance =
            size_ * std::hypot(static_cast<double>(dy), static_cast<double>(dx));
        bool found = dx == 0 && dy == 0;
        for (int64_t n = 1; !found && n <= kJump + 1; ++n) {
          found = take({at[0] + n * dy, at[1] + n * dx}, height, kSteepest * distance + kLeastStep);
        }
      }
    }
  }
  return ground;
}

GroundHeights smoothed(const GroundHeights& ground) {
  GroundHeights smooth(ground.size());
  for (const auto& [cell, height] : ground.cells()) {
    double sum = 0.0;
    int count = 0;
    for (int64_t y = cell[0] - 1; y <= cell[0] + 1; ++y) {
      for (int64_t x = cell[1] - 1; x <= cell[1] + 1; ++x) {
        if (const auto near = ground.at({y, x})) {
          sum += *near;
          ++count;
        }
      }
    }
    smooth.set(cell, sum / count);
  }
  return smooth;
}

}  // namespace adit
