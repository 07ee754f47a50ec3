// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Where something was that was not there all the time: found by the rays of all submaps, after the
// map is made (docs/theory/mapping.md). free_space.hpp finds what moves within one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <unordered_set>
#include <vector>

#include <Eigen/Geometry>

#include "adit/engine/kernels/free_space.hpp"
#include "adit/slam/submaps/keyframe_submap.hpp"

namespace adit {

/// A voxel of the map's frame, counted from its origin.
using VoxelIndex = Eigen::Matrix<int64_t, 3, 1>;
/// The voxel that a point lies in; both m.
VoxelIndex voxel_of(const Eigen::Vector3d& p, double edge);
/// A number for it, which no voxel within a million has as well.
uint64_t key_of(const VoxelIndex& voxel);

/// Voxels in which points are of what has moved.
class MovedSpace {
 public:
  explicit MovedSpace(double edge) : edge_(edge) {}

  void add(const VoxelIndex& voxel);
  /// Map frame, m.
  bool contains(const Eigen::Vector3d& point) const;
  double edge() const { return edge_; }  ///< of a voxel, m
  std::size_t voxels() const { return voxels_.size(); }

 private:
  double edge_;
  std::unordered_set<uint64_t> voxels_;
};

/// A square of the map, as high as it may be.
struct SpaceTile {
  VoxelIndex centre = VoxelIndex::Zero();
  int64_t across = 0;  ///< voxels, even
};

/// What has been seen from a keyframe, in the map.
struct PlacedSubmap {
  Eigen::Isometry3d T_map_keyframe = Eigen::Isometry3d::Identity();
  std::shared_ptr<const KeyframeSubmap> submap;
};

/// Every point was seen from its sensor's place: what lies between was free. Each submap says of a
/// voxel that it sees something in it or beside it, that its rays go through, or nothing; where at
/// least two say "through", and half as many again as see something, what is in it has moved.
class MovedSpaceSearch {
 public:
  /// `edge`: of a voxel, m.
  MovedSpaceSearch(engine::Context& context, double edge);

  /// Of the tile. `submap` gives each of the submaps that reach into it, twice, in their order.
  std::vector<VoxelIndex> in_tile(const SpaceTile& tile, std::size_t submaps,
                                  const std::function<PlacedSubmap(std::size_t)>& submap) const;

 private:
  std::vector<gpu::SpaceVoxel> count_votes(
      std::vector<gpu::SpaceVoxel> table, const SpaceTile& tile, std::size_t submaps,
      const std::function<PlacedSubmap(std::size_t)>& submap) const;

  engine::Context* context_;
  engine::FreeSpaceVotes kernels_;
  double edge_;
};

/// The table of a tile's voxels that hold points of these submaps, without votes. It is as the
/// device wants it (engine::FreeSpaceVotes); empty where no point lies in the tile.
std::vector<gpu::SpaceVoxel> space_table(const SpaceTile& tile, double edge, std::size_t submaps,
                                         const std::function<PlacedSubmap(std::size_t)>& submap);

/// A submap's points in the tile or beside it, and the parts of its rays in the tile.
std::vector<gpu::SpaceRay> space_rays(const SpaceTile& tile, double edge,
                                      const PlacedSubmap& placed);

}  // namespace adit
