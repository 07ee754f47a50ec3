// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Adds a cloud to a Gaussian voxel map, or takes it out again, exactly: all sums are integers. One
// thread takes points strided over all threads. Written: count and mean of their voxels, and number
// and constraints of their surfaces or, with kMoments, the second moments of their offsets.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/include/surface.glsl"
#include "adit/shaders/include/texels.glsl"
#include "adit/shaders/shared/gaussian_cell.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;
layout(constant_id = 3) const bool kMoments = false;

layout(set = 0, binding = 0, scalar) readonly buffer Cloud { uvec4 surface_cloud[]; };
layout(set = 0, binding = 1, scalar) buffer Voxels { GaussianCell voxels[]; };
layout(set = 0, binding = 2, scalar) buffer Counters { VoxelMapCounters counters; };
layout(set = 0, binding = 3) uniform utextureBuffer surface_cloud_texels;
layout(push_constant, scalar) uniform Push { VoxelMapAddPush push; };

void main() {
  const uint threads = gl_NumWorkGroups.x * kLocalSize;
  for (uint i = gl_GlobalInvocationID.x; i < push.point_count; i += threads) {
    const uvec4 point = FETCH(surface_cloud, i);
    const vec3 p = vec4(uintBitsToFloat(point.xyz), 1.0) * push.pose;
    const vec3 v = vec4(unpack_direction(point.w), 0.0) * push.pose;
    const vec2 w = surface_weights(point.w);
    const vec3 scaled = p * push.inverse_cell;
    const vec3 corner = floor(scaled);
    const uint key = pack_voxel(ivec3(corner));
    if (key == kFree) {
      atomicAdd(counters.out_of_range, 1);
      continue;
    }
    uint slot = mix32(key) & push.table_mask;
    uint probes = 0;
    uint found = atomicCompSwap(voxels[slot].key, kFree, key);
    while (found != key && found != kFree && probes < kMaxProbes) {
      slot = (slot + 1) & push.table_mask;
      found = atomicCompSwap(voxels[slot].key, kFree, key);
      probes += 1;
    }
    if (found == kFree) {
      atomicAdd(counters.used_slots, 1);
    } else if (found != key) {
      atomicAdd(counters.failures, 1);
      continue;
    }
    const uvec3 offset = fixed_offset(scaled, corner);
    uvec3 x;
    uvec3 y;  // yy, yz, zz
    if (kMoments) {
      x = (offset.x * offset + 32768u) >> 16;
      y = (offset.yyz * offset.yzz + 32768u) >> 16;
    } else {
      // P = w.x I + w.y v v^T, entries within [-1, 1], stored as (entry + 1) * 32768.
      const vec3 vy = w.y * v.yyz * v.yzz;
      x = uvec3((w.y * v.x * v + vec3(w.x, 0.0, 0.0) + 1.0) * 32768.0);
      y = uvec3((vy + vec3(w.x, 0.0, w.x) + 1.0) * 32768.0);
    }
    const float facing =
        !kMoments && (point.w >> 30) == kPlane ? dot(v, vec3(kFacingX, kFacingY, kFacingZ)) : 0.0;
    const uint along = facing > kUnclearFacing ? 1u << kFacingShift : 0u;
    const uint against = facing < -kUnclearFacing ? 1u << kFacingShift : 0u;
    const uint before = atomicAdd(voxels[slot].count, (1u + along) * push.sign);
    if (push.sign == 1u && (before & kCountMask) == kMostCellPoints) {
      atomicAdd(counters.crowded, 1);
    }
    atomicAdd(voxels[slot].sum_x, offset.x * push.sign);
    atomicAdd(voxels[slot].sum_y, offset.y * push.sign);
    atomicAdd(voxels[slot].sum_z, offset.z * push.sign);
    if (!kMoments) {
      if ((point.w >> 30) == kIsotropic) {
        continue;
      }
      atomicAdd(voxels[slot].surfaces, (1u + against) * push.sign);
    }
    atomicAdd(voxels[slot].xx, x.x * push.sign);
    atomicAdd(voxels[slot].xy, x.y * push.sign);
    atomicAdd(voxels[slot].xz, x.z * push.sign);
    atomicAdd(voxels[slot].yy, y.x * push.sign);
    atomicAdd(voxels[slot].yz, y.y * push.sign);
    atomicAdd(voxels[slot].zz, y.z * push.sign);
  }
}
