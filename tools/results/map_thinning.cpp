// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/results/map_thinning.hpp"

#include <cmath>

namespace adit {

std::size_t MapThinning::Hash::operator()(const Voxel& voxel) const {
  // Odd multipliers spread neighbouring voxels; the folds carry the high bits down.
  uint64_t hash = static_cast<uint64_t>(voxel.x) * 0x9E3779B97F4A7C15ULL;
  hash = (hash ^ (hash >> 32U)) + static_cast<uint64_t>(voxel.y) * 0xC2B2AE3D27D4EB4FULL;
  hash = (hash ^ (hash >> 29U)) + static_cast<uint64_t>(voxel.z) * 0x165667B19E3779F9ULL;
  return static_cast<std::size_t>(hash ^ (hash >> 32U));
}

bool MapThinning::take(const Eigen::Vector3d& point) {
  const auto cell = [&](double coordinate) {
    return static_cast<int64_t>(std::floor(coordinate / resolution_));
  };
  return taken_.insert({cell(point.x()), cell(point.y()), cell(point.z())}).second;
}

}  // namespace adit
