// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/noise_space.hpp"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <vector>

#include <Eigen/Geometry>

#include "adit/slam/submaps/submap_cache.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/map_products/map_tiles.hpp"
#include "adit/tools/support/parallel.hpp"

namespace adit {
namespace {

constexpr double kFinestNoise = 0.2;  // m, a voxel's edge
// Of a tile: so narrow that its voxels take little memory, so wide that a submap is in a few.
constexpr int64_t kNoiseTileAcross = 256;
constexpr int64_t kReach = 2;  // voxels, to each side
// Points in the cube, its own included. A surface as large as the cube has 25 cells in each of the
// submaps that saw it, and an edge 5.
constexpr uint32_t kMostAlone = 2;

struct NoiseVoxel {
  VoxelIndex index;
  uint32_t points = 0;
};
using Voxels = std::unordered_map<uint64_t, NoiseVoxel>;

/// The tile, and as far around it as neighbours count.
struct NoiseTile {
  TileNumber number;
  int64_t margin = 0;  ///< voxels

  bool holds(const VoxelIndex& voxel) const {
    const VoxelIndex first(number.x * kNoiseTileAcross - margin,
                           number.y * kNoiseTileAcross - margin, 0);
    const int64_t across = kNoiseTileAcross + 2 * margin;
    return voxel.x() >= first.x() && voxel.x() < first.x() + across && voxel.y() >= first.y() &&
           voxel.y() < first.y() + across;
  }
};

uint32_t points_in(const Voxels& voxels, const VoxelIndex& voxel) {
  const auto found = voxels.find(key_of(voxel));
  return found == voxels.end() ? 0 : found->second.points;
}

/// Whether the cube around a voxel holds hardly a point.
bool is_alone(const Voxels& voxels, const VoxelIndex& voxel) {
  uint32_t points = 0;
  for (int64_t x = -kReach; x <= kReach; ++x) {
    for (int64_t y = -kReach; y <= kReach; ++y) {
      for (int64_t z = -kReach; z <= kReach; ++z) {
        points += points_in(voxels, voxel + VoxelIndex(x, y, z));
        if (points > kMostAlone) {
          return false;
        }
      }
    }
  }
  return true;
}

/// The voxels of a tile that hold points, in any order.
std::vector<VoxelIndex> voxels_of(const Voxels& voxels, const NoiseTile& tile) {
  std::vector<VoxelIndex> inside;
  for (const auto& [key, voxel] : voxels) {
    if (tile.holds(voxel.index)) {
      inside.push_back(voxel.index);
    }
  }
  return inside;
}

/// Adds a voxel without neighbours, and the empty voxels around it.
void add_alone(NoiseSpace& noise, const Voxels& voxels, const VoxelIndex& voxel) {
  for (int64_t x = -1; x <= 1; ++x) {
    for (int64_t y = -1; y <= 1; ++y) {
      for (int64_t z = -1; z <= 1; ++z) {
        const VoxelIndex beside = voxel + VoxelIndex(x, y, z);
        if (beside == voxel || points_in(voxels, beside) == 0) {
          noise.add(beside);
        }
      }
    }
  }
}

/// Keyframes that may have points in a tile or in the margin around it, in the order of ids.
std::map<TileNumber, std::vector<MapKeyframe>> keyframes_around(const MapDatabase& map,
                                                                double edge) {
  std::map<TileNumber, std::vector<MapKeyframe>> tiles;
  const TileGrid grid{.cell = edge, .across = kNoiseTileAcross};
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(edge * static_cast<double>(kReach + 1));
  const std::map<NodeId, Eigen::AlignedBox3d> sights = boxes_of_sight(map);
  for (const MapKeyframe& keyframe : map.keyframes()) {
    const Eigen::AlignedBox3d& box = sights.at(keyframe.id);
    visit_tiles(grid, {box.min().head<2>() - margin, box.max().head<2>() + margin},
                [&](const TileNumber& tile) { tiles[tile].push_back(keyframe); });
  }
  return tiles;
}

}  // namespace

NoiseSpace find_noise_space(const MapDatabase& map, uint64_t submap_bytes,
                            const std::function<void(std::size_t, std::size_t)>& progress) {
  SubmapCache cache(submap_loader(map), submap_bytes);
  double edge = kFinestNoise;
  if (const std::vector<MapKeyframe> keyframes = map.keyframes(); !keyframes.empty()) {
    edge = std::max(edge, load_submap(cache, keyframes.front().id, map.file())->r_submap);
  }
  const auto tiles = keyframes_around(map, edge);
  NoiseSpace noise(edge);
  std::size_t done = 0;
  for (const auto& [number, keyframes] : tiles) {
    Voxels voxels;
    const NoiseTile around{.number = number, .margin = kReach};
    for (const MapKeyframe& keyframe : keyframes) {
      const auto submap = load_submap(cache, keyframe.id, map.file());
      for (const SubmapPoint& point : submap->points) {
        const VoxelIndex voxel = voxel_of(keyframe.T_map_keyframe * point.position(), edge);
        if (around.holds(voxel)) {
          NoiseVoxel& one = voxels[key_of(voxel)];
          one.index = voxel;
          ++one.points;
        }
      }
    }
    const std::vector<VoxelIndex> inside = voxels_of(voxels, {.number = number, .margin = 0});
    std::vector<char> alone(inside.size());
    in_parallel(inside.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        alone[i] = is_alone(voxels, inside[i]) ? 1 : 0;
      }
    });
    for (std::size_t i = 0; i < inside.size(); ++i) {
      if (alone[i] != 0) {
        add_alone(noise, voxels, inside[i]);
      }
    }
    progress(++done, tiles.size());
  }
  return noise;
}

}  // namespace adit
