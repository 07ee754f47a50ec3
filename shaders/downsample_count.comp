// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Voxel down-sampling, pass 2 of 3: counts the points that come first in their cell. Thread t of all threads
// takes the t-th part of the sweep; the counts it and its group found are written for pass 3, which so knows
// where to put its own: the output is in the order of the raw points, whatever the order of execution was.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "shaders/include/hash.glsl"
#include "shaders/shared/preprocess.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) readonly buffer Slots { uint slot_of[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Table { InputCell cells[]; };
layout(set = 0, binding = 2, scalar) writeonly buffer ThreadCounts { uint thread_counts[]; };
layout(set = 0, binding = 3, scalar) writeonly buffer GroupCounts { uint group_counts[]; };
layout(push_constant, scalar) uniform Push { CountPush push; };

shared uint group_count;

void main() {
  if (gl_LocalInvocationIndex == 0) {
    group_count = 0;
  }
  barrier();
  const uint part = (push.point_count + gl_NumWorkGroups.x * kLocalSize - 1) / (gl_NumWorkGroups.x * kLocalSize);
  const uint begin = gl_GlobalInvocationID.x * part;
  const uint end = min(begin + part, push.point_count);
  uint count = 0;
  for (uint i = begin; i < end; ++i) {
    const uint slot = slot_of[i];
    if (slot != kFree) {
      count += cells[slot - 1].inverted_first == ~i ? 1 : 0;
    }
  }
  thread_counts[gl_GlobalInvocationID.x] = count;
  const uint sum = subgroupAdd(count);
  if (subgroupElect()) {
    atomicAdd(group_count, sum);
  }
  barrier();
  if (gl_LocalInvocationIndex == 0) {
    group_counts[gl_WorkGroupID.x] = group_count;
  }
}
