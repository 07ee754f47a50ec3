// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/maps/tiled_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <compare>
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
// The index of places is in single precision, and rounds outwards.
constexpr double kMargin = 1e-3;  // m

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

/// Ordered by rows.
struct Tile {
  int64_t y = 0;
  int64_t x = 0;
  auto operator<=>(const Tile&) const = default;
};

class Tiles {
 public:
  Tiles(const MapDatabase& map, double resolution, uint64_t submap_bytes)
      : map_(&map),
        resolution_(resolution),
        across_(voxels_across(resolution)),
        cache_(map, submap_bytes) {
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
      poses_.emplace(keyframe.id, keyframe.T_map_keyframe);
      const Tile first = tile_of(box->second.min() - Eigen::Vector3d::Constant(kMargin));
      const Tile last = tile_of(box->second.max() + Eigen::Vector3d::Constant(kMargin));
      for (Tile tile = first; tile.y <= last.y; ++tile.y) {
        for (tile.x = first.x; tile.x <= last.x; ++tile.x) {
          submaps_[tile].push_back(keyframe.id);
        }
      }
    }
  }

  void visit(const std::function<void(std::span<const Point>)>& take) {
    for (const auto& [tile, ids] : submaps_) {
      const std::vector<Point>& points = points_of(tile, ids);
      if (!points.empty()) {
        take(points);
      }
    }
  }

 private:
  int64_t voxel_of(double coordinate) const {
    return static_cast<int64_t>(std::floor(coordinate / resolution_));
  }
  Tile tile_of(const Eigen::Vector3d& point) const {
    return {.y = floor_divided(voxel_of(point.y()), across_),
            .x = floor_divided(voxel_of(point.x()), across_)};
  }

  static bool is_possible(const Eigen::AlignedBox3d& box) {
    return (box.min().array().abs() < kFarthest).all() &&
           (box.max().array().abs() < kFarthest).all() && (box.sizes().array() < kLargest).all();
  }

  const std::vector<Point>& points_of(const Tile& tile, const std::vector<NodeId>& ids) {
    points_.clear();
    MapThinning thinning(resolution_);
    for (const NodeId id : ids) {
      const auto submap = load_submap(cache_, id, map_->file());
      const Eigen::Isometry3d& T_map_keyframe = poses_.at(id);
      for (const SubmapPoint& point : submap->points) {
        const Eigen::Vector3d p = T_map_keyframe * point.position();
        if (tile_of(p) == tile && thinning.take(p)) {
          const Eigen::Vector3f single = p.cast<float>();
          points_.push_back({.x = single.x(), .y = single.y(), .z = single.z()});
        }
      }
    }
    return points_;
  }

  const MapDatabase* map_;
  double resolution_;
  int64_t across_;  ///< voxels
  SubmapCache cache_;
  std::map<NodeId, Eigen::Isometry3d> poses_;
  std::map<Tile, std::vector<NodeId>> submaps_;  ///< that reach into them, in the order of ids
  std::vector<Point> points_;                    ///< of the tile that was visited last
};

}  // namespace

void visit_thinned_cloud(const MapDatabase& map, double resolution, uint64_t submap_bytes,
                         const std::function<void(std::span<const Point>)>& take) {
  Tiles(map, resolution, submap_bytes).visit(take);
}

}  // namespace adit
