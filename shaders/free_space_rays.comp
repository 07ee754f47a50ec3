// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Which of a tile's voxels the rays of a submap go through that sees nothing there itself
// (free_space_hits.comp comes first). One thread takes rays strided over all threads.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/shared/free_space.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) readonly buffer Rays { SpaceRay rays[]; };
layout(set = 0, binding = 1, scalar) buffer Voxels { SpaceVoxel voxels[]; };
layout(push_constant, scalar) uniform Push { SpacePush push; };

#include "adit/shaders/include/space_voxel.glsl"

ivec3 unpack_direction(uint packed) {
  const int bits = int(kDirectionBits);
  return ivec3(bitfieldExtract(int(packed), 0, bits), bitfieldExtract(int(packed), bits, bits),
               bitfieldExtract(int(packed), 2 * bits, bits));
}

// It crosses what the voxel holds, rather than passing along it.
bool crosses(ivec3 direction, uint packed_normal) {
  const ivec3 products = direction * unpack_direction(packed_normal);
  return packed_normal == 0 || abs(products.x + products.y + products.z) > kLeastSlant;
}

void main() {
  const uint threads = gl_NumWorkGroups.x * kLocalSize;
  for (uint i = gl_GlobalInvocationID.x; i < push.ray_count; i += threads) {
    const SpaceRay ray = rays[push.begin + i];
    const ivec3 step = ivec3(ray.step_x, ray.step_y, ray.step_z);
    const ivec3 direction = unpack_direction(ray.direction);
    ivec3 at = ivec3(ray.from_x, ray.from_y, ray.from_z);
    for (uint k = 0; k < ray.samples; ++k) {
      const uint slot = slot_of(at >> int(kSpaceBits));
      if (slot != kNoVoxel && voxels[slot].seen_by != push.submap &&
          crosses(direction, voxels[slot].normal) &&
          atomicExchange(voxels[slot].through_by, push.submap) != push.submap) {
        atomicAdd(voxels[slot].through, 1);
      }
      at += step;
    }
  }
}
