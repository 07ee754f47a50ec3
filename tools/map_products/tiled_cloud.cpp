// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/tiled_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "adit/slam/submaps/submap_cache.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/map_products/map_tiles.hpp"
#include "adit/tools/results/map_thinning.hpp"

namespace adit {
namespace {

// A tile is so many voxels wide, but neither so narrow that each submap is in dozens of tiles, nor
// wider than sensors see.
constexpr double kVoxelsAcross = 512.0;
constexpr double kNarrowest = 16.0;  // m
constexpr double kWidest = 256.0;    // m
// m: points of a square of that side are in memory at a time.
constexpr double kFilledAtATime = 64.0;

int64_t voxels_across(double resolution) {
  const double width = std::clamp(kVoxelsAcross * resolution, kNarrowest, kWidest);
  return std::max(int64_t{1}, std::lround(width / resolution));
}

void visit(const MapDatabase& map, const ProductCoordinates& coordinates, const TileGrid& grid,
           const TiledCloud& wanted, uint64_t submap_bytes, const TakeTile& take) {
  SubmapCache cache(submap_loader(map), submap_bytes);
  std::vector<CloudPoint> chosen;
  for (const auto& [tile, keyframes] :
       keyframes_by_tile(map, coordinates, wanted.selection, grid)) {
    std::optional<MapThinning> thinning;
    if (wanted.resolution) {
      thinning.emplace(*wanted.resolution);
    }
    for (const MapKeyframe& keyframe : keyframes) {
      chosen.clear();
      const auto submap = load_submap(cache, keyframe.id, map.file());
      for (const CloudPoint& point :
           points_of_keyframe(keyframe, *submap, coordinates, wanted.selection)) {
        if (grid.tile_of(point.position.head<2>()) == tile &&
            (!thinning || is_dropped(wanted.selection, point) || thinning->take(point.position))) {
          chosen.push_back(point);
        }
      }
      if (!chosen.empty()) {
        take(tile, chosen);
      }
    }
  }
}

}  // namespace

std::vector<CloudPoint> points_of_keyframe(const MapKeyframe& keyframe,
                                           const KeyframeSubmap& submap,
                                           const ProductCoordinates& coordinates,
                                           const CloudSelection& selection) {
  std::vector<CloudPoint> points;
  points.reserve(submap.points.size());
  for (const SubmapPoint& measured : submap.points) {
    const Nanoseconds time = measured.sweep < submap.sweeps.size()
                                 ? submap.sweeps[measured.sweep].stamp
                                 : keyframe.stamp;
    const Eigen::Vector3d position = keyframe.T_map_keyframe * measured.position();
    if (selection.is_gone && selection.is_gone(position, keyframe.session)) {
      continue;
    }
    CloudPoint point{.position = coordinates.from_map(position),
                     .in_map = position,
                     .time = time,
                     .keyframe = keyframe.id,
                     .session = keyframe.session,
                     .moving = measured.seen_through || has_moved(selection, position)};
    classify(selection, position, point);
    if (is_wanted(selection, point)) {
      points.push_back(point);
    }
  }
  return points;
}

void visit_cloud(const MapDatabase& map, const ProductCoordinates& coordinates,
                 const CloudSelection& selection, const TakeCloud& take) {
  for (const MapKeyframe& keyframe : map.keyframes()) {
    if (!selection.sessions.empty() && !selection.sessions.contains(keyframe.session)) {
      continue;
    }
    take(points_of_keyframe(keyframe, load_submap(map, keyframe.id, map.file()), coordinates,
                            selection));
  }
}

void visit_tiles(const MapDatabase& map, const ProductCoordinates& coordinates,
                 const TiledCloud& wanted, uint64_t submap_bytes, const TakeTile& take) {
  // A submap reaches into dozens of small tiles: several are filled at a time.
  const auto across = static_cast<int64_t>(std::max(1.0, std::floor(kFilledAtATime / wanted.size)));
  const TileGrid tiles{.cell = wanted.size, .across = 1};
  std::map<TileNumber, std::vector<CloudPoint>> filled;
  TileNumber square;
  const auto empty_out = [&] {
    for (const auto& [tile, points] : filled) {
      take(tile, points);
    }
    filled.clear();
  };
  visit(map, coordinates, {.cell = wanted.size, .across = across}, wanted, submap_bytes,
        [&](const TileNumber& number, std::span<const CloudPoint> points) {
          if (number != square) {
            empty_out();
            square = number;
          }
          for (const CloudPoint& point : points) {
            filled[tiles.tile_of(point.position.head<2>())].push_back(point);
          }
        });
  empty_out();
}

void visit_thinned_cloud(const MapDatabase& map, const ProductCoordinates& coordinates,
                         const CloudSelection& selection, double resolution, uint64_t submap_bytes,
                         const TakeCloud& take) {
  visit(map, coordinates, {.cell = resolution, .across = voxels_across(resolution)},
        {.size = 0.0, .resolution = resolution, .selection = selection}, submap_bytes,
        [&](const TileNumber&, std::span<const CloudPoint> points) { take(points); });
}

void visit_thinned_cloud(const MapDatabase& map, double resolution, uint64_t submap_bytes,
                         const std::function<void(std::span<const Point>)>& take) {
  std::vector<Point> single;
  visit_thinned_cloud(map, {}, {}, resolution, submap_bytes,
                      [&](std::span<const CloudPoint> points) {
                        single.clear();
                        for (const CloudPoint& point : points) {
                          const Eigen::Vector3f p = point.position.cast<float>();
                          single.push_back({.x = p.x(), .y = p.y(), .z = p.z()});
                        }
                        take(single);
                      });
}

}  // namespace adit
