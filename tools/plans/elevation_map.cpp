// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/plans/elevation_map.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/LU>

#include "adit/slam/core/units.hpp"

namespace adit {
namespace {

void visit_beside(const GroundHeights::Index& cell, const auto& visit) {
  for (int64_t y = -1; y <= 1; ++y) {
    for (int64_t x = -1; x <= 1; ++x) {
      visit(GroundHeights::Index{cell[0] + y, cell[1] + x});
    }
  }
}

/// Rise over run of the plane through the heights by least squares; nothing where they lie on a
/// line.
std::optional<double> slope_of(const GroundHeights& heights, const Eigen::Vector2d& middle) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const auto& [cell, height] : heights.cells()) {
    const Eigen::Vector2d from = (heights.middle(cell) - middle) / heights.size();
    const Eigen::Vector3d row(1.0, from.x(), from.y());
    information += row * row.transpose();
    right += height * row;
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> solver(information);
  if (!solver.isInvertible()) {
    return {};
  }
  return Eigen::Vector3d(solver.solve(right)).tail<2>().norm() / heights.size();
}

}  // namespace

void ElevationMap::add(std::span<const PlanPoint> points) {
  for (const PlanPoint& point : points) {
    const auto above = planes_->height_above(point.position);
    if (!above || *above > kHeadroom) {
      continue;
    }
    Cell& cell = cells_[grid_.index_of(point.position.head<2>())];
    if (planes_->is_ground(point.position)) {
      cell.points += 1.0;
      cell.heights += point.position.z();
      cell.above += *above;
      cell.squares += *above * *above;
    } else if (*above > 0.0) {
      cell.obstacle = std::max(cell.obstacle, *above);
    }
  }
}

ElevationLayers ElevationMap::layers() const {
  const double size = grid_.size();
  ElevationLayers layers{.elevation = GroundHeights(size),
                         .variance = GroundHeights(size),
                         .slope = GroundHeights(size),
                         .roughness = GroundHeights(size),
                         .step_height = GroundHeights(size),
                         .obstacle_height = GroundHeights(size)};
  for (const auto& [index, cell] : cells_) {
    if (cell.points > 0.0) {
      // In the cell's middle, wherever in it the points are.
      const Eigen::Vector2d middle = grid_.middle(index);
      const double mean = cell.heights / cell.points;
      const auto above = planes_->height_above({middle.x(), middle.y(), mean});
      layers.elevation.set(index, above ? mean - *above + cell.above / cell.points : mean);
      layers.obstacle_height.set(index, cell.obstacle);
    }
  }
  for (const auto& [index, height] : layers.elevation.cells()) {
    GroundHeights around(size);
    Cell sum;
    double step = 0.0;
    visit_beside(index, [&](const GroundHeights::Index& beside) {
      if (const auto other = layers.elevation.at(beside)) {
        const Cell& cell = cells_.at(beside);
        around.set(beside, *other);
        step = std::max(step, std::abs(*other - height));
        sum.points += cell.points;
        sum.above += cell.above;
        sum.squares += cell.squares;
      }
    });
    if (around.cells().size() > 1) {
      layers.step_height.set(index, step);
    }
    if (const auto slope = slope_of(around, around.middle(index))) {
      layers.slope.set(index, std::atan(*slope) * kDegreesPerRadian);
    }
    if (sum.points > 1.0) {
      const double mean = sum.above / sum.points;
      const double variance =
          std::max(0.0, sum.squares - sum.points * mean * mean) / (sum.points - 1.0);
      layers.roughness.set(index, std::sqrt(variance));
      layers.variance.set(index, variance / cells_.at(index).points);
    }
  }
  return layers;
}

}  // namespace adit
