// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A map in squares, so that no more of it than one of them needs is in memory at a time.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include <Eigen/Geometry>

#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_products/cloud_selection.hpp"
#include "adit/tools/map_products/product_coordinates.hpp"

namespace adit {

/// A square of a plane, compared row by row: from size * (x, y) to size * (x + 1, y + 1).
struct TileNumber {
  int64_t y = 0;
  int64_t x = 0;
  auto operator<=>(const TileNumber&) const = default;
};

/// Squares of `across` cells of `cell` m: a voxel is never in two of them.
struct TileGrid {
  double cell = 1.0;  ///< m
  int64_t across = 1;

  TileNumber tile_of(const Eigen::Vector2d& p) const;
};

/// The box around what each keyframe has seen and the place that it was seen from, map frame, m.
/// Throws InputError where the map is damaged.
std::map<NodeId, Eigen::AlignedBox3d> boxes_of_sight(const MapDatabase& map);

/// Visits the tiles that a box of the plane reaches into, row by row.
void visit_tiles(const TileGrid& grid, const Eigen::AlignedBox2d& box,
                 const std::function<void(const TileNumber&)>& visit);

/// Keyframes whose submaps, or the rays from them, may reach into each tile, in the order of ids.
/// Throws InputError where the map is damaged.
std::map<TileNumber, std::vector<MapKeyframe>> keyframes_by_tile(
    const MapDatabase& map, const ProductCoordinates& coordinates, const CloudSelection& selection,
    const TileGrid& grid);

}  // namespace adit
