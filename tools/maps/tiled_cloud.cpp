// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/maps/tiled_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "adit/slam/mapping/submap_cache.hpp"
#include "adit/tools/maps/map_trajectory.hpp"
#include "adit/tools/results/map_thinning.hpp"

namespace adit {
namespace {

// A tile is so many voxels wide, but neither so narrow that each submap is in dozens of tiles, nor
// wider than sensors see.
constexpr double kVoxelsAcross = 512.0;
constexpr double kNarrowest = 16.0;  // m
constexpr double kWidest = 256.0;    // m
// The index of places is in single precision, and rounds outwards; in coordinates that are turned
// and scaled a box is no box any more, by less than this share of it.
constexpr double kMargin = 1e-3;  // m
constexpr double kMarginShare = 1e-3;

// m: points of a square of that side are in memory at a time.
constexpr double kFilledAtATime = 64.0;

int64_t voxels_across(double resolution) {
  const double width = std::clamp(kVoxelsAcross * resolution, kNarrowest, kWidest);
  return std::max(int64_t{1}, std::lround(width / resolution));
}

int64_t floor_divided(int64_t number, int64_t by) {
  return number / by - static_cast<int64_t>(number % by < 0);
}

// Beyond this a box is no box of what a sensor has seen.
constexpr double kFarthest = 1e8;  // m
constexpr double kLargest = 1e4;   // m

bool is_possible(const Eigen::AlignedBox3d& box) {
  return (box.min().array().abs() < kFarthest).all() &&
         (box.max().array().abs() < kFarthest).all() && (box.sizes().array() < kLargest).all();
}

Eigen::AlignedBox2d box_in(const ProductCoordinates& coordinates, const Eigen::AlignedBox3d& box) {
  Eigen::AlignedBox2d plane;
  for (int corner = 0; corner < 8; ++corner) {
    const auto type = static_cast<Eigen::AlignedBox3d::CornerType>(corner);
    plane.extend(
        Eigen::Vector2d(coordinates.from_map(Eigen::Vector3d(box.corner(type))).head<2>()));
  }
  const double margin =
      kMargin +
      (coordinates.frame() == ProductFrame::map ? 0.0 : kMarginShare * plane.sizes().maxCoeff());
  return {plane.min() - Eigen::Vector2d::Constant(margin),
          plane.max() + Eigen::Vector2d::Constant(margin)};
}

/// Squares of `across` cells of `cell` m: a voxel is never in two of them.
struct Grid {
  double cell = 1.0;  ///< m
  int64_t across = 1;

  int64_t number(double coordinate) const {
    return floor_divided(static_cast<int64_t>(std::floor(coordinate / cell)), across);
  }
  TileNumber tile_of(const Eigen::Vector2d& p) const {
    return {.y = number(p.y()), .x = number(p.x())};
  }
};

/// Keyframes whose submaps may reach into each tile, in the order of ids.
std::map<TileNumber, std::vector<MapKeyframe>> keyframes_by_tile(
    const MapDatabase& map, const ProductCoordinates& coordinates, const CloudSelection& selection,
    const Grid& grid) {
  std::map<TileNumber, std::vector<MapKeyframe>> tiles;
  const std::map<NodeId, Eigen::AlignedBox3d> boxes = map.boxes();
  for (const MapKeyframe& keyframe : map.keyframes()) {
    const auto box = boxes.find(keyframe.id);
    if (box == boxes.end() || !is_possible(box->second)) {
      throw InputError(map.file(), {},
                       "submap " + std::to_string(keyframe.id) +
                           " has no place, or none that is "
                           "possible",
                       "`adit check` says what else is wrong");
    }
    if (!selection.sessions.empty() && !selection.sessions.contains(keyframe.session)) {
      continue;
    }
    const Eigen::AlignedBox2d plane = box_in(coordinates, box->second);
    const TileNumber first = grid.tile_of(plane.min());
    const TileNumber last = grid.tile_of(plane.max());
    for (TileNumber tile = first; tile.y <= last.y; ++tile.y) {
      for (tile.x = first.x; tile.x <= last.x; ++tile.x) {
        tiles[tile].push_back(keyframe);
      }
    }
  }
  return tiles;
}

void visit(const MapDatabase& map, const ProductCoordinates& coordinates, const Grid& grid,
           const TiledCloud& wanted, uint64_t submap_bytes, const TakeTile& take) {
  SubmapCache cache(map, submap_bytes);
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
            (!thinning || thinning->take(point.position))) {
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
    const CloudPoint point{.position = coordinates.from_map(
                               Eigen::Vector3d(keyframe.T_map_keyframe * measured.position())),
                           .time = time,
                           .keyframe = keyframe.id,
                           .session = keyframe.session,
                           .moving = measured.seen_through};
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
  const Grid tiles{.cell = wanted.size, .across = 1};
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
