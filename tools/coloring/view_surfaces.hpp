// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "adit/slam/coloring/view_coloring.hpp"
#include "adit/slam/core/recently_used.hpp"
#include "adit/slam/submaps/moved_space.hpp"
#include "adit/slam/submaps/submap_cache.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_products/map_tiles.hpp"

namespace adit {

/// A point of the map by which images are compared.
struct SurfaceSample {
  /// Its own, the same whenever it is asked for; the upper four bits are zero.
  uint64_t key = 0;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  ///< map frame, m
};

/// The surfaces of a map on the device, tile by tile: one a voxel of the submaps' spacing. Those
/// that were needed last stay.
class ViewSurfaces {
 public:
  /// Without what is in `moved`, which may be null. `submap_bytes` of decoded submaps stay in
  /// memory. Throws InputError where the map is damaged.
  ViewSurfaces(const MapDatabase& map, const ViewColoring& coloring,
               std::shared_ptr<const MovedSpace> moved, uint64_t submap_bytes);

  /// m, between neighbouring surfaces.
  double spacing() const { return grid_.cell; }

  /// Those of all tiles within `reach` (m) of a place, map frame, m.
  std::vector<std::shared_ptr<const ViewColoring::Surfaces>> near(const Eigen::Vector3d& place,
                                                                  double reach);
  /// One in so many of their points.
  static constexpr uint64_t kOneIn = 16;
  std::vector<SurfaceSample> samples_near(const Eigen::Vector3d& place, double reach);

 private:
  struct Tile {
    std::shared_ptr<const ViewColoring::Surfaces> surfaces;  ///< null: nothing is in the tile
    std::vector<SurfaceSample> samples{};
  };
  /// Null: no keyframe sees into the tile.
  const Tile* tile(const TileNumber& number);
  Tile make(const TileNumber& number);

  const MapDatabase* map_;
  std::shared_ptr<const MovedSpace> moved_;
  const ViewColoring* coloring_;
  SubmapCache submaps_;
  TileGrid grid_;
  std::map<TileNumber, std::vector<MapKeyframe>> keyframes_;
  RecentlyUsed<TileNumber, Tile> kept_;
};

}  // namespace adit
