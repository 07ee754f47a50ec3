// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "adit/tools/plans/wall_lines.hpp"

namespace adit {

/// Walls by the squares that they run through.
class WallIndex {
 public:
  /// `size`: m, of a square.
  WallIndex(const std::vector<WallSegment>& walls, double size);

  /// Those within `size` of a place, and others.
  std::set<std::size_t> near(const Eigen::Vector2d& place) const;

 private:
  std::pair<int64_t, int64_t> square(const Eigen::Vector2d& place) const;

  double size_;
  std::map<std::pair<int64_t, int64_t>, std::set<std::size_t>> squares_;
};

/// m, from a place to the nearest point of a wall.
double distance(const WallSegment& wall, const Eigen::Vector2d& place);

/// Puts ends of walls where their lines cross, if that is within `reach` (m) of both ends or on the
/// other wall: near a corner the points' surfaces are neither the one nor the other wall's.
void join_corners(std::vector<WallSegment>& walls, double reach);

}  // namespace adit
