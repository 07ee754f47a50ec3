// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The cloud of a map piece by piece: memory holds submaps of up to so many bytes and what one tile
// needs, whatever the map's size.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/slam/submaps/keyframe_submap.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_products/cloud_selection.hpp"
#include "adit/tools/map_products/map_tiles.hpp"
#include "adit/tools/map_products/product_coordinates.hpp"

namespace adit {

/// All points in the order of keyframes. Throws InputError where the map is damaged.
void visit_cloud(const MapDatabase& map, const ProductCoordinates& coordinates,
                 const CloudSelection& selection, const TakeCloud& take);

/// The points of a submap that are wanted.
std::vector<CloudPoint> points_of_keyframe(const MapKeyframe& keyframe,
                                           const KeyframeSubmap& submap,
                                           const ProductCoordinates& coordinates,
                                           const CloudSelection& selection);

using TakeTile = std::function<void(const TileNumber&, std::span<const CloudPoint>)>;

struct TiledCloud {
  double size = 100.0;  ///< m, of a tile
  /// m: one point a voxel, the first in the order of keyframes.
  std::optional<double> resolution{};
  CloudSelection selection{};
};

/// Tile by tile, each once and as a whole, those of a neighbourhood one after the other. Throws
/// InputError where the map is damaged.
void visit_tiles(const MapDatabase& map, const ProductCoordinates& coordinates,
                 const TiledCloud& wanted, uint64_t submap_bytes, const TakeTile& take);

/// One point a voxel of `resolution` (m), in tiles that are a whole number of voxels wide.
void visit_thinned_cloud(const MapDatabase& map, const ProductCoordinates& coordinates,
                         const CloudSelection& selection, double resolution, uint64_t submap_bytes,
                         const TakeCloud& take);

/// The same of the whole map in its own frame.
void visit_thinned_cloud(const MapDatabase& map, double resolution, uint64_t submap_bytes,
                         const std::function<void(std::span<const Point>)>& take);

}  // namespace adit
