// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a map has points that panes of glass mirror: they are measured behind the pane.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_set>

#include "adit/slam/submaps/moved_space.hpp"
#include "adit/tools/map_database/map_database.hpp"

namespace adit {

/// Voxels whose points are images in a pane of glass.
class MirrorSpace {
 public:
  explicit MirrorSpace(double edge) : edge_(edge) {}

  void add(const VoxelIndex& voxel) { voxels_.insert(key_of(voxel)); }
  /// Map frame, m.
  bool contains(const Eigen::Vector3d& point) const {
    return !voxels_.empty() && voxels_.contains(key_of(voxel_of(point, edge_)));
  }
  double edge() const { return edge_; }  ///< of a voxel, m
  std::size_t voxels() const { return voxels_.size(); }
  std::size_t panes = 0;  ///< panes of glass that the map has

 private:
  double edge_;
  std::unordered_set<uint64_t> voxels_;
};

/// A pane of glass is a plane that more rays go through than end at. A point behind a pane, as its
/// sensor saw it, is an image where the place that mirrors it holds points of the map. Surfaces
/// square to the pane go on behind it as they are before it: they are kept. A voxel counts by the
/// majority of its points; the empty voxels beside it are in, too. Memory holds all voxels of the
/// submaps' cells (0.2 m at least) that have points. `progress` gets keyframes that are done, and
/// all. Throws InputError where the map is damaged.
MirrorSpace find_mirror_space(const MapDatabase& map, uint64_t submap_bytes,
                              const std::function<void(std::size_t, std::size_t)>& progress);

}  // namespace adit
