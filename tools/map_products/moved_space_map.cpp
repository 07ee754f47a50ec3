// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/moved_space_map.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "adit/slam/submaps/submap_cache.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/map_products/map_tiles.hpp"

namespace adit {
namespace {

constexpr double kFinest = 0.2;  // m, a voxel's edge
// Of a tile: so narrow that its voxels take little memory, so wide that a submap is in a few.
constexpr int64_t kMovedTileAcross = 256;

/// The height of the tile's middle, in voxels: sensors are never far above or below what they see.
int64_t middle(const std::vector<MapKeyframe>& keyframes, double edge) {
  double sum = 0.0;
  for (const MapKeyframe& keyframe : keyframes) {
    sum += keyframe.T_map_keyframe.translation().z();
  }
  return std::llround(sum / static_cast<double>(keyframes.size()) / edge);
}

}  // namespace

MovedSpace find_moved_space(const MapDatabase& map, engine::Context& context, uint64_t submap_bytes,
                            const std::function<void(std::size_t, std::size_t)>& progress) {
  SubmapCache cache(submap_loader(map), submap_bytes);
  double edge = kFinest;
  if (const std::vector<MapKeyframe> keyframes = map.keyframes(); !keyframes.empty()) {
    edge = std::max(edge, load_submap(cache, keyframes.front().id, map.file())->r_submap);
  }
  const std::map<TileNumber, std::vector<MapKeyframe>> tiles =
      keyframes_by_tile(map, {}, {}, {.cell = edge, .across = kMovedTileAcross});
  const MovedSpaceSearch search(context, edge);
  MovedSpace moved(edge);
  std::size_t done = 0;
  for (const auto& [tile, keyframes] : tiles) {
    const SpaceTile space{
        .centre = {tile.x * kMovedTileAcross + kMovedTileAcross / 2,
                   tile.y * kMovedTileAcross + kMovedTileAcross / 2, middle(keyframes, edge)},
        .across = kMovedTileAcross};
    const auto submap = [&, &of_tile = keyframes](std::size_t i) {
      return PlacedSubmap{.T_map_keyframe = of_tile[i].T_map_keyframe,
                          .submap = load_submap(cache, of_tile[i].id, map.file())};
    };
    for (const VoxelIndex& voxel : search.in_tile(space, keyframes.size(), submap)) {
      moved.add(voxel);
    }
    progress(++done, tiles.size());
  }
  return moved;
}

}  // namespace adit
