// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Exercises uniform texel buffers between storage buffers, in both ways GLSL declares them: result
// i is texel order[i] of the table, xor texel i of the mask, plus the offset in each component.
// sums[0] is the sum of all components of all results, sums[1] the number of results (both modulo
// 2^32).
#version 460
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require

#include "adit/shaders/shared/engine_probe.h"

layout(constant_id = 0) const uint kLocalSize = 64;
layout(local_size_x_id = 0) in;

layout(set = 0, binding = 0, scalar) readonly buffer Order { uint order[]; };
layout(set = 0, binding = 1) uniform utextureBuffer table;
layout(set = 0, binding = 2) uniform usamplerBuffer mask;
layout(set = 0, binding = 3, scalar) buffer Output {
  ProbeSums sums;
  uvec4 results[];
};
layout(push_constant, scalar) uniform Push { TexelProbePush push; };

void main() {
  uint sum = 0;
  uint items = 0;
  for (uint i = gl_GlobalInvocationID.x; i < push.count; i += gl_NumWorkGroups.x * kLocalSize) {
    const uvec4 bits = texelFetch(table, int(order[i])) ^ texelFetch(mask, int(i));
    const uvec4 result = bits + push.offset;
    results[i] = result;
    sum += result.x + result.y + result.z + result.w;
    items += 1;
  }
  if (items > 0) {
    atomicAdd(sums.total, sum);
    atomicAdd(sums.items, items);
  }
}
