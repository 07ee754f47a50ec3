// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Merges a sweep's cloud into the submap of a keyframe: a hash grid of cells of edge r_submap. One
// thread takes points strided over all threads. Written: count and sum of the offsets of the cells'
// points, and which sensor saw one of them from nearest; all of them whole numbers, so that the
// order of points and clouds does not matter.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/include/hash.glsl"
#include "adit/shaders/shared/submap.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) readonly buffer Cloud { vec4 cloud[]; };
layout(set = 0, binding = 1, scalar) buffer Cells { MergeCell cells[]; };
layout(set = 0, binding = 2, scalar) buffer Counters { MergeCounters counters; };
layout(push_constant, scalar) uniform Push { MergePush push; };

const uint kMostRange = (1u << (32u - kSweepBits)) - 1u;

void main() {
  const uint threads = gl_NumWorkGroups.x * kLocalSize;
  for (uint i = gl_GlobalInvocationID.x; i < push.point_count; i += threads) {
    const vec3 seen = cloud[push.begin + i].xyz;
    const vec3 scaled = (vec4(seen, 1.0) * push.pose) * push.inverse_cell;
    const vec3 corner = floor(scaled);
    const uint key = pack_voxel(ivec3(corner));
    if (key == kFree) {
      atomicAdd(counters.out_of_range, 1);
      continue;
    }
    uint slot = mix32(key) & push.table_mask;
    uint probes = 0;
    uint found = atomicCompSwap(cells[slot].key, kFree, key);
    while (found != key && found != kFree && probes < kMaxProbes) {
      slot = (slot + 1) & push.table_mask;
      found = atomicCompSwap(cells[slot].key, kFree, key);
      probes += 1;
    }
    if (found == kFree) {
      atomicAdd(counters.used_slots, 1);
    } else if (found != key) {
      atomicAdd(counters.failures, 1);
      continue;
    }
    const uvec3 offset = fixed_offset(scaled, corner);
    const uint range = min(uint(length(seen) * kRangeSteps), kMostRange);
    atomicAdd(cells[slot].count, 1);
    atomicAdd(cells[slot].sum_x, offset.x);
    atomicAdd(cells[slot].sum_y, offset.y);
    atomicAdd(cells[slot].sum_z, offset.z);
    atomicMax(cells[slot].inverted_nearest, ~((range << kSweepBits) | push.sweep));
  }
}
