// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include <Eigen/Core>

namespace adit {

/// Keeps the first point that falls into each voxel of a grid, so that the same points in the same
/// order leave the same cloud. Remembers the voxels that are taken: its memory grows with the cloud
/// it lets through, by 8 bytes a voxel in a table that is at most half full.
class MapThinning {
 public:
  /// `resolution` > 0, m: the edge of a voxel; `expected`: voxels that there is to be room for.
  explicit MapThinning(double resolution, std::size_t expected = 0)
      : resolution_(resolution), table_(std::bit_ceil(std::max(kLeast, 2 * expected))) {}

  /// Whether a point (map frame, m) is the first of its voxel.
  bool take(const Eigen::Vector3d& point);

  std::size_t voxels() const { return taken_ + far_.size(); }

 private:
  using Voxel = std::array<int64_t, 3>;
  static constexpr std::size_t kLeast = std::size_t{1} << 12U;  ///< of the table

  bool take_key(uint64_t key);
  void grow();

  double resolution_;
  std::vector<uint64_t> table_;  ///< open addressing; of the keys of voxels, or 0
  std::size_t taken_ = 0;        ///< in the table
  std::optional<Voxel> origin_;  ///< of keys: the first voxel, wherever the frame has its origin
  std::set<Voxel> far_;          ///< taken, too far from that for a key
};

}  // namespace adit
