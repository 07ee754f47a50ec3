// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Voxels in the hash tables of the device, as shaders/include/hash.glsl has them.
#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "adit/shaders/shared/gaussian_cell.h"

namespace adit {

/// MurmurHash3's finaliser.
constexpr uint32_t mix32(uint32_t h) {
  h ^= h >> 16U;
  h *= 0x85ebca6bU;
  h ^= h >> 13U;
  h *= 0xc2b2ae35U;
  h ^= h >> 16U;
  return h;
}

/// gpu::kFree for what lies outside of the keys' range.
inline uint32_t pack_voxel(const Eigen::Vector3i& voxel) {
  const auto x = static_cast<uint32_t>(voxel.x() + gpu::kVoxelsSideways + 1);
  const auto y = static_cast<uint32_t>(voxel.y() + gpu::kVoxelsSideways + 1);
  const auto z = static_cast<uint32_t>(voxel.z() + gpu::kVoxelsUpwards + 1);
  const bool inside = x < 2047U && y < 2048U && z < 1024U;
  return inside ? ((x << 21U) | (y << 10U) | z) + 1U : gpu::kFree;
}

inline Eigen::Vector3i unpack_voxel(uint32_t key) {
  const uint32_t packed = key - 1;
  return {static_cast<int>(packed >> 21U) - gpu::kVoxelsSideways - 1,
          static_cast<int>((packed >> 10U) & 2047U) - gpu::kVoxelsSideways - 1,
          static_cast<int>(packed & 1023U) - gpu::kVoxelsUpwards - 1};
}

}  // namespace adit
