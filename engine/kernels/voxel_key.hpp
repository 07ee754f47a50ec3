// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Voxels in the hash tables of the device, as shaders/include/hash.glsl has them.
#pragma once

#include <array>
#include <cstdint>

#include "adit/shaders/shared/gaussian_cell.h"

namespace adit::engine {

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
constexpr uint32_t pack_voxel(int x, int y, int z) {
  const auto biased_x = static_cast<uint32_t>(x + gpu::kVoxelsSideways + 1);
  const auto biased_y = static_cast<uint32_t>(y + gpu::kVoxelsSideways + 1);
  const auto biased_z = static_cast<uint32_t>(z + gpu::kVoxelsUpwards + 1);
  const bool inside = biased_x < 2047U && biased_y < 2048U && biased_z < 1024U;
  return inside ? ((biased_x << 21U) | (biased_y << 10U) | biased_z) + 1U : gpu::kFree;
}

/// x, y, z.
constexpr std::array<int, 3> unpack_voxel(uint32_t key) {
  const uint32_t packed = key - 1U;
  return {static_cast<int>(packed >> 21U) - gpu::kVoxelsSideways - 1,
          static_cast<int>((packed >> 10U) & 2047U) - gpu::kVoxelsSideways - 1,
          static_cast<int>(packed & 1023U) - gpu::kVoxelsUpwards - 1};
}

}  // namespace adit::engine
