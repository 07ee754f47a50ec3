// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_set>

#include <Eigen/Core>

namespace adit {

/// Keeps the first point that falls into each voxel of a grid, so that the same points in the same
/// order leave the same cloud. Remembers the voxels that are taken: its memory grows with the cloud
/// it lets through.
class MapThinning {
 public:
  /// `resolution` > 0, m: the edge of a voxel.
  explicit MapThinning(double resolution) : resolution_(resolution) {}

  /// Whether a point (map frame, m) is the first of its voxel.
  bool take(const Eigen::Vector3d& point);

  std::size_t voxels() const { return taken_.size(); }

 private:
  struct Voxel {
    int64_t x, y, z;
    bool operator==(const Voxel&) const = default;
  };
  struct Hash {
    std::size_t operator()(const Voxel& voxel) const;
  };

  double resolution_;
  std::unordered_set<Voxel, Hash> taken_;
};

}  // namespace adit
