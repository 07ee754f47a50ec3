// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The ground that a path leads over, and what continues it: no tables, roofs or tree tops, however
// level they are.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "adit/tools/plans/plan_points.hpp"
#include "adit/tools/plans/storeys.hpp"

namespace adit {

/// Heights of the ground in square cells.
class GroundHeights {
 public:
  using Index = std::array<int64_t, 2>;  ///< row and column; borders at multiples of the size

  explicit GroundHeights(double size) : size_(size) {}

  double size() const { return size_; }
  void set(const Index& cell, double height) { heights_[cell] = height; }
  std::optional<double> at(const Index& cell) const;
  Eigen::Vector2d middle(const Index& cell) const;
  Index index_of(const Eigen::Vector2d& place) const;
  /// In the order of rows and columns.
  const std::map<Index, double>& cells() const { return heights_; }

 private:
  double size_;
  std::map<Index, double> heights_;
};

/// Level surfaces as they come in, in cells.
class GroundSearch {
 public:
  /// `size`: m, of a cell.
  explicit GroundSearch(double size) : size_(size) {}

  /// Points on surfaces of 45 degrees or more to the horizontal count for nothing.
  void add(std::span<const PlanPoint> points);

  /// Of each cell the height that is reached from the path by steps from cell to cell that loose
  /// ground can have: 45 degrees. `steps`: with floors under them.
  GroundHeights reached_from(std::span<const FloorStep> steps) const;

 private:
  struct Level {
    double sum = 0.0;
    double points = 0.0;
  };
  /// The heights of a cell's surfaces, the lowest first.
  std::vector<double> surfaces(const GroundHeights::Index& cell) const;

  double size_;
  std::map<std::array<int64_t, 3>, Level> levels_;  // row, column, level
};

/// Each height the mean of those of up to nine cells: noise of cells makes contours that nobody
/// can read.
GroundHeights smoothed(const GroundHeights& ground);

}  // namespace adit
