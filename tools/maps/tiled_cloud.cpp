// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/maps/tiled_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <map>
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

struct Tile {
  int64_t x = 0;
  int64_t y = 0;
  bool operator==(const Tile&) const = default;
};

class Tiles {
 public:
  Tiles(const MapDatabase& map, double resolution, uint64_t submap_bytes)
      : map_(&map),
        resolution_(resolution),
        across_(voxels_across(resolution)),
        cache_(map, submap_bytes) {
    for (const MapKeyframe& keyframe : map.keyframes()) {
      poses_.emplace(keyframe.id, keyframe.T_map_keyframe);
    }
  }

  void visit(const std::function<void(std::span<const Point>)>& take) {
    const Eigen::AlignedBox3d extent = map_->extent();
    if (extent.isEmpty()) {
      return;
    }
    const Tile first = tile_of(extent.min() - Eigen::Vector3d::Constant(kMargin));
    const Tile last = tile_of(extent.max() + Eigen::Vector3d::Constant(kMargin));
    for (Tile tile = first; tile.y <= last.y; ++tile.y) {
      for (tile.x = first.x; tile.x <= last.x; ++tile.x) {
        const std::vector<Point>& points = points_of(tile, extent);
        if (!points.empty()) {
          take(points);
        }
      }
    }
  }

 private:
  int64_t voxel_of(double coordinate) const {
    return static_cast<int64_t>(std::floor(coordinate / resolution_));
  }
  Tile tile_of(const Eigen::Vector3d& point) const {
    return {floor_divided(voxel_of(point.x()), across_),
            floor_divided(voxel_of(point.y()), across_)};
  }

  const std::vector<Point>& points_of(const Tile& tile, const Eigen::AlignedBox3d& extent) {
    points_.clear();
    MapThinning thinning(resolution_);
    const double edge = resolution_ * static_cast<double>(across_);
    const Eigen::Vector3d lower(edge * static_cast<double>(tile.x) - kMargin,
                                edge * static_cast<double>(tile.y) - kMargin,
                                extent.min().z() - kMargin);
    const Eigen::Vector3d upper(lower.x() + edge + 2.0 * kMargin, lower.y() + edge + 2.0 * kMargin,
                                extent.max().z() + kMargin);
    for (const NodeId id : map_->submaps_within(lower, upper)) {
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
  std::vector<Point> points_;  ///< of the tile that was visited last
};

}  // namespace

void visit_thinned_cloud(const MapDatabase& map, double resolution, uint64_t submap_bytes,
                         const std::function<void(std::span<const Point>)>& take) {
  Tiles(map, resolution, submap_bytes).visit(take);
}

}  // namespace adit
