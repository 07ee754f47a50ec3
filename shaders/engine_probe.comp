// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Exercises what every kernel relies on: push constants, two buffers, specialization, subgroup
// arithmetic and integer atomics. One thread adds kScale * input + offset of its strided items and
// writes each result; a group adds its sum to sums[0] and the number of its items to sums[1] (both
// modulo 2^32).
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_basic : require

#include "adit/shaders/shared/engine_probe.h"

layout(constant_id = 0) const uint kLocalSize = 64;
layout(constant_id = 1) const uint kScale = 1;
layout(local_size_x_id = 0) in;

layout(set = 0, binding = 0, scalar) readonly buffer Input { uint values[]; };
layout(set = 0, binding = 1, scalar) buffer Output {
  ProbeSums sums;
  uint results[];
};
layout(push_constant, scalar) uniform Push { ProbePush push; };

void main() {
  uint sum = 0;
  uint items = 0;
  for (uint i = gl_GlobalInvocationID.x; i < push.count; i += gl_NumWorkGroups.x * kLocalSize) {
    const uint result = kScale * values[i] + push.offset;
    results[i] = result;
    sum += result;
    items += 1;
  }
  sum = subgroupAdd(sum);
  items = subgroupAdd(items);
  if (subgroupElect()) {
    atomicAdd(sums.total, sum);
    atomicAdd(sums.items, items);
  }
}
