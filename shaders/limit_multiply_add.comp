// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Measures how fast a device multiplies and adds: one thread runs kChains recurrences x <- a x + b
// side by side, from different starts, and writes their sum.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/shared/limit_probes.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) writeonly buffer Results { float results[]; };
layout(push_constant, scalar) uniform Push { LimitMultiplyAddPush push; };

void main() {
  const float start = float(gl_LocalInvocationIndex) * 0.125;
  const vec4 factor = vec4(push.factor);
  const vec4 addend = vec4(push.addend);
  vec4 low = vec4(0.0, 1.0, 2.0, 3.0) + start;
  vec4 high = vec4(4.0, 5.0, 6.0, 7.0) + start;
  for (uint round = 0; round < push.rounds; ++round) {
    for (uint step = 0; step < kChainSteps; ++step) {
      low = fma(low, factor, addend);
      high = fma(high, factor, addend);
    }
  }
  const vec4 sum = low + high;
  results[gl_GlobalInvocationID.x] = sum.x + sum.y + sum.z + sum.w;
}
