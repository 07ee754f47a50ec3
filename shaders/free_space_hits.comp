// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Which of a tile's voxels a submap sees something in, or in one that shares a face: where a
// surface is, points fall now into one, now into its neighbour. One thread takes points strided
// over all threads.
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

const ivec3 kFaces[7] = ivec3[](ivec3(0), ivec3(1, 0, 0), ivec3(-1, 0, 0), ivec3(0, 1, 0),
                                ivec3(0, -1, 0), ivec3(0, 0, 1), ivec3(0, 0, -1));

void main() {
  const uint threads = gl_NumWorkGroups.x * kLocalSize;
  for (uint i = gl_GlobalInvocationID.x; i < push.ray_count; i += threads) {
    const SpaceRay ray = rays[push.begin + i];
    for (uint face = 0; face < 7; ++face) {
      const uint slot = slot_of(ivec3(ray.hit_x, ray.hit_y, ray.hit_z) + kFaces[face]);
      if (slot != kNoVoxel && atomicExchange(voxels[slot].seen_by, push.submap) != push.submap) {
        atomicAdd(voxels[slot].seen, 1);
      }
    }
  }
}
