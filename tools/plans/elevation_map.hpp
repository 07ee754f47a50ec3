// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The ground as robots that walk or drive over it need it: a number a cell and layer.
#pragma once

#include <map>
#include <span>

#include "adit/tools/plans/ground_planes.hpp"
#include "adit/tools/plans/plan_points.hpp"

namespace adit {

/// Layers of an elevation map, by the names of ANYbotics' elevation_mapping and grid_map_filters.
struct ElevationLayers {
  GroundHeights elevation;        ///< m, in the cell's middle, by the ground's points
  GroundHeights variance;         ///< m2, of that mean
  GroundHeights slope;            ///< degrees, of the plane through up to nine cells
  GroundHeights roughness;        ///< m, standard deviation of points about the ground's plane
  GroundHeights step_height;      ///< m, largest difference to one of its eight neighbours
  GroundHeights obstacle_height;  ///< m above the ground, of the highest point below kHeadroom
};
/// m: what is higher is passed below. Lintels of doors are not lower (DIN 18101: 2.0 m and more).
inline constexpr double kHeadroom = 2.0;

/// Points as they come in, in cells.
class ElevationMap {
 public:
  /// `cell`: m. The planes are referred to.
  ElevationMap(const GroundPlanes& planes, double cell) : planes_(&planes), grid_(cell) {}

  void add(std::span<const PlanPoint> points);
  ElevationLayers layers() const;

 private:
  struct Cell {
    double points = 0.0;    ///< of the ground
    double heights = 0.0;   ///< m, their sum
    double above = 0.0;     ///< m, sum of what they are above the plane
    double squares = 0.0;   ///< m2, of that
    double obstacle = 0.0;  ///< m above the ground; 0: none
  };

  const GroundPlanes* planes_;
  GroundHeights grid_;
  std::map<GroundHeights::Index, Cell> cells_{};
};

}  // namespace adit
