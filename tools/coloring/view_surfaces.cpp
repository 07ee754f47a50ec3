// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/coloring/view_surfaces.hpp"

#include <cmath>
#include <unordered_set>
#include <utility>

#include "adit/slam/submaps/moved_space.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"

namespace adit {
namespace {

constexpr double kTile = 32.0;                                // m: a view looks at a few
constexpr uint64_t kMostSurfaceBytes = uint64_t{128} << 20U;  // of surfaces that stay

double spacing_of(const MapDatabase& map, SubmapCache& submaps) {
  const std::vector<MapKeyframe> keyframes = map.keyframes();
  return keyframes.empty() ? 1.0 : load_submap(submaps, keyframes.front().id, map.file())->r_submap;
}

/// A number for a voxel whose bits are spread evenly, by Fibonacci hashing (Knuth 1973).
uint64_t hash_of(const VoxelIndex& voxel) {
  return key_of(voxel) * 0x9e3779b97f4a7c15U;
}

}  // namespace

ViewSurfaces::ViewSurfaces(const MapDatabase& map, const ViewColoring& coloring,
                           std::shared_ptr<const MovedSpace> moved, uint64_t submap_bytes)
    : map_(&map),
      moved_(std::move(moved)),
      coloring_(&coloring),
      submaps_(submap_loader(map), submap_bytes),
      kept_(kMostSurfaceBytes) {
  grid_.cell = spacing_of(map, submaps_);
  grid_.across = static_cast<int64_t>(std::ceil(kTile / grid_.cell));
  keyframes_ = keyframes_by_tile(map, {}, {}, grid_);
}

std::vector<std::shared_ptr<const ViewColoring::Surfaces>> ViewSurfaces::near(
    const Eigen::Vector3d& place, double reach) {
  std::vector<std::shared_ptr<const ViewColoring::Surfaces>> all;
  const Eigen::Vector2d around(reach, reach);
  visit_tiles(grid_, {place.head<2>() - around, place.head<2>() + around},
              [&](const TileNumber& number) {
                if (const Tile* one = tile(number); one != nullptr && one->surfaces) {
                  all.push_back(one->surfaces);
                }
              });
  return all;
}

std::vector<SurfaceSample> ViewSurfaces::samples_near(const Eigen::Vector3d& place, double reach) {
  std::vector<SurfaceSample> all;
  const Eigen::Vector2d around(reach, reach);
  visit_tiles(grid_, {place.head<2>() - around, place.head<2>() + around},
              [&](const TileNumber& number) {
                if (const Tile* one = tile(number)) {
                  all.insert(all.end(), one->samples.begin(), one->samples.end());
                }
              });
  return all;
}

const ViewSurfaces::Tile* ViewSurfaces::tile(const TileNumber& number) {
  if (!keyframes_.contains(number)) {
    return nullptr;
  }
  if (const Tile* known = kept_.find(number)) {
    return known;
  }
  Tile made = make(number);
  const uint64_t bytes = made.surfaces ? made.surfaces->elements.size() : 0;
  return &kept_.add(number, std::move(made), bytes);
}

ViewSurfaces::Tile ViewSurfaces::make(const TileNumber& number) {
  const double across = grid_.cell * static_cast<double>(grid_.across);
  const Eigen::Vector3d origin((static_cast<double>(number.x) + 0.5) * across,
                               (static_cast<double>(number.y) + 0.5) * across, 0.0);
  std::vector<gpu::ViewSurface> elements;
  Tile made{.surfaces = nullptr};
  std::unordered_set<uint64_t> taken;
  for (const MapKeyframe& keyframe : keyframes_.at(number)) {
    const auto submap = load_submap(submaps_, keyframe.id, map_->file());
    for (const SubmapPoint& point : submap->points) {
      const Eigen::Vector3d p = keyframe.T_map_keyframe * point.position();
      if (point.seen_through || (moved_ && moved_->contains(p)) ||
          grid_.tile_of(p.head<2>()) != number ||
          !taken.insert(key_of(voxel_of(p, grid_.cell))).second) {
        continue;
      }
      if (const uint64_t key = hash_of(voxel_of(p, grid_.cell)); (key >> 60U) % kOneIn == 0) {
        made.samples.push_back({.key = key, .p = p});
      }
      const Eigen::Vector3f local = (p - origin).cast<float>();
      elements.push_back(
          {.p = {local.x(), local.y(), local.z()},
           .surface = turned_surface(keyframe.T_map_keyframe.linear(), point.surface)});
    }
  }
  if (!elements.empty()) {
    made.surfaces = coloring_->make_surfaces(origin, elements);
  }
  return made;
}

}  // namespace adit
