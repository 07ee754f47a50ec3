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

/// m, of a step from cell to cell besides the slope: kerbs, rails, and noise.
inline constexpr double kGroundStep = 0.1;
/// Cells without points that a step may cross. It may rise no more than to the next cell: what is
/// hidden is no cliff.
inline constexpr int64_t kGroundGap = 3;

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

/// The ground of all storeys: of each cell the heights (m), in the order in which they were
/// reached.
using GroundLevels = std::map<GroundHeights::Index, std::vector<double>>;

/// Level surfaces as they come in, in cells.
class GroundSearch {
 public:
  /// `size`: m, of a cell.
  explicit GroundSearch(double size) : size_(size) {}

  /// Points on surfaces of 45 degrees or more to the horizontal count for nothing.
  void add(std::span<const PlanPoint> points);

  /// Of each cell the heights that are reached from the path by steps from cell to cell that loose
  /// ground can have: 45 degrees. Heights of a cell are a storey apart. `steps`: with floors under
  /// them.
  GroundLevels levels_from(std::span<const FloorStep> steps) const;

 private:
  struct Level {
    double sum = 0.0;
    double points = 0.0;
  };
  /// The heights of each cell's surfaces, the lowest first.
  std::map<GroundHeights::Index, std::vector<double>> surfaces() const;

  double size_;
  std::map<std::array<int64_t, 3>, Level> levels_;  // row, column, level
};

/// Each height the mean of those of up to nine cells: noise of cells makes contours that nobody
/// can read.
GroundHeights smoothed(const GroundHeights& ground);

}  // namespace adit
