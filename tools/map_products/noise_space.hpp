// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a map has points that nothing is beside: echoes of dust, rain and edges, and no surfaces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_set>

#include "adit/slam/submaps/moved_space.hpp"
#include "adit/tools/map_database/map_database.hpp"

namespace adit {

/// Voxels whose points are noise.
class NoiseSpace {
 public:
  explicit NoiseSpace(double edge) : edge_(edge) {}

  void add(const VoxelIndex& voxel) { voxels_.insert(key_of(voxel)); }
  /// Map frame, m.
  bool contains(const Eigen::Vector3d& point) const {
    return voxels_.contains(key_of(voxel_of(point, edge_)));
  }

 private:
  double edge_;
  std::unordered_set<uint64_t> voxels_;
};

/// Voxels of the submaps' cells (0.2 m at least) whose points are alone: the cube of five voxels a
/// side around them holds hardly another point of any submap. The empty voxels beside them are in,
/// too: a return may lie in another one than the submap's point that it became part of. The map is
/// searched in tiles: memory holds one, and the submaps that reach into it. `progress` gets tiles
/// that are done, and all. Throws InputError where the map is damaged.
NoiseSpace find_noise_space(const MapDatabase& map, uint64_t submap_bytes,
                            const std::function<void(std::size_t, std::size_t)>& progress);

}  // namespace adit
