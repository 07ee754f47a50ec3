// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Adds a cloud to a Gaussian voxel map, or takes it out again, exactly: all sums are integers. One
// thread takes points strided over all threads. Written: count and mean of their voxels, and number
// and constraints of their surfaces or, with kMoments, the second moments of their offsets.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#ifdef ADIT_WIDE
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#endif
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

#ifdef ADIT_WIDE
// Subtracts where the cloud is taken out: as long as no sum overflows, words do not carry into each
// other, and what they carried is taken back with the points that made them overflow.
uint64_t signed_pair(uint low, uint high) {
  const uint64_t mask = push.sign == 1u ? uint64_t(0) : ~uint64_t(0);
  return (pack64(uvec2(low, high)) ^ mask) - mask;
}

void add_sums(uint slot, uvec3 offset, uvec3 x, uvec3 y, uint surfaces, bool bare) {
  atomicAdd(voxels[slot].sum_x_sum_y, signed_pair(offset.x, offset.y));
  atomicAdd(voxels[slot].sum_z_xx, signed_pair(offset.z, bare ? 0 : x.x));
  if (!bare) {
    atomicAdd(voxels[slot].xy_xz, signed_pair(x.y, x.z));
    atomicAdd(voxels[slot].yy_yz, signed_pair(y.x, y.y));
    atomicAdd(voxels[slot].zz_surfaces, signed_pair(y.z, surfaces));
  }
}
#else
void add_sums(uint slot, uvec3 offset, uvec3 x, uvec3 y, uint surfaces, bool bare) {
  atomicAdd(voxels[slot].sum_x, offset.x * push.sign);
  atomicAdd(voxels[slot].sum_y, offset.y * push.sign);
  atomicAdd(voxels[slot].sum_z, offset.z * push.sign);
  if (!bare) {
    if (!kMoments) {
      atomicAdd(voxels[slot].surfaces, surfaces * push.sign);
    }
    atomicAdd(voxels[slot].xx, x.x * push.sign);
    atomicAdd(voxels[slot].xy, x.y * push.sign);
    atomicAdd(voxels[slot].xz, x.z * push.sign);
    atomicAdd(voxels[slot].yy, y.x * push.sign);
    atomicAdd(voxels[slot].yz, y.y * push.sign);
    atomicAdd(voxels[slot].zz, y.z * push.sign);
  }
}
#endif

void main() {
  const uint threads = gl_NumWorkGroups.x * kLocalSize;
  VoxelMapCounters found = VoxelMapCounters(0, 0, 0, 0);
  for (uint i = gl_GlobalInvocationID.x; i < push.point_count; i += threads) {
    const uvec4 point = FETCH(surface_cloud, i);
    const vec3 p = vec4(uintBitsToFloat(point.xyz), 1.0) * push.pose;
    const vec3 v = vec4(unpack_direction(point.w), 0.0) * push.pose;
    const vec2 w = surface_weights(point.w);
    const vec3 scaled = p * push.inverse_cell;
    const vec3 corner = floor(scaled);
    const uint key = pack_voxel(ivec3(corner));
    if (key == kFree) {
      found.out_of_range += 1;
      continue;
    }
    uint slot = mix32(key) & push.table_mask;
    uint probes = 0;
    uint owner = atomicCompSwap(voxels[slot].key, kFree, key);
    while (owner != key && owner != kFree && probes < kMaxProbes) {
      slot = (slot + 1) & push.table_mask;
      owner = atomicCompSwap(voxels[slot].key, kFree, key);
      probes += 1;
    }
    found.used_slots += owner == kFree ? 1 : 0;
    if (owner != key && owner != kFree) {
      found.failures += 1;
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
    found.crowded += push.sign == 1u && (before & kCountMask) == kMostCellPoints ? 1 : 0;
    add_sums(slot, offset, x, y, kMoments ? 0 : 1u + against,
             !kMoments && (point.w >> 30) == kIsotropic);
  }
  if (found.used_slots > 0) {
    atomicAdd(counters.used_slots, found.used_slots);
  }
  if (found.failures + found.out_of_range + found.crowded > 0) {
    atomicAdd(counters.failures, found.failures);
    atomicAdd(counters.out_of_range, found.out_of_range);
    atomicAdd(counters.crowded, found.crowded);
  }
}
