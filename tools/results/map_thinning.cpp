// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/results/map_thinning.hpp"

#include <cmath>
#include <utility>

namespace adit {
namespace {

constexpr unsigned kKeyBits = 21;                               // of each coordinate
constexpr uint64_t kFarthest = uint64_t{1} << (kKeyBits - 1U);  // voxels from the first one

/// The bits of a number in others, high ones in low ones too (the finaliser of MurmurHash3).
uint64_t mixed(uint64_t key) {
  key = (key ^ (key >> 33U)) * 0xFF51AFD7ED558CCDULL;
  key = (key ^ (key >> 33U)) * 0xC4CEB9FE1A85EC53ULL;
  return key ^ (key >> 33U);
}

}  // namespace

bool MapThinning::take(const Eigen::Vector3d& point) {
  Voxel voxel;
  for (std::size_t axis = 0; axis < voxel.size(); ++axis) {
    voxel[axis] =
        static_cast<int64_t>(std::floor(point[static_cast<Eigen::Index>(axis)] / resolution_));
  }
  const Voxel& origin = origin_ ? *origin_ : origin_.emplace(voxel);
  uint64_t key = 1;  // no key is 0
  for (std::size_t axis = 0; axis < voxel.size(); ++axis) {
    const uint64_t place =
        static_cast<uint64_t>(voxel[axis]) - static_cast<uint64_t>(origin[axis]) + kFarthest;
    if (place >= 2 * kFarthest) {
      return far_.insert(voxel).second;
    }
    key = (key << kKeyBits) | place;
  }
  return take_key(key);
}

bool MapThinning::take_key(uint64_t key) {
  if (2 * taken_ >= table_.size()) {
    grow();
  }
  const std::size_t mask = table_.size() - 1;
  std::size_t at = mixed(key) & mask;
  while (table_[at] != 0) {
    if (table_[at] == key) {
      return false;
    }
    at = (at + 1) & mask;
  }
  table_[at] = key;
  ++taken_;
  return true;
}

void MapThinning::grow() {
  const std::vector<uint64_t> before =
      std::exchange(table_, std::vector<uint64_t>(2 * table_.size()));
  taken_ = 0;
  for (const uint64_t key : before) {
    if (key != 0) {
      take_key(key);
    }
  }
}

}  // namespace adit
