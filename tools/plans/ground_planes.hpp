// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Which points lie on the ground that ground_surface.hpp has found.
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "adit/tools/plans/ground_surface.hpp"

namespace adit {

/// The ground as a plane a cell and storey, fitted to the heights of the cells around it. Cells
/// without ground near some have the plane of the nearest one.
class GroundPlanes {
 public:
  /// `size`: m, of the cells of `levels`.
  GroundPlanes(const GroundLevels& levels, double size);

  /// How far the point is above the ground of the storey that is nearest to it, m, negative below;
  /// both in the product's coordinates. Nothing where no ground is known.
  std::optional<double> height_above(const Eigen::Vector3d& point) const;

  /// Within what ground is thick.
  bool is_ground(const Eigen::Vector3d& point) const;
  /// Below the ground of all storeys.
  bool is_below(const Eigen::Vector3d& point) const;

 private:
  struct Plane {
    float height = 0.0F;  ///< m, in the middle of its cell
    float slope_x = 0.0F;
    float slope_y = 0.0F;
  };
  /// The planes of a cell: its own, or those of another one so many cells from it.
  struct Range {
    uint32_t first = 0;
    uint16_t count = 0;
    int8_t to_row = 0;
    int8_t to_column = 0;
  };

  Plane fitted(const GroundLevels& levels, const GroundHeights::Index& cell, double height) const;
  void spread(const GroundLevels& levels);
  /// Heights of the planes (m) at a place.
  std::vector<double> heights_at(const Eigen::Vector2d& place) const;

  GroundHeights grid_;
  std::vector<Plane> planes_;
  std::unordered_map<uint64_t, Range> cells_;
};

}  // namespace adit
