// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Measures how fast a device copies: one thread copies uvec4 strided over all threads.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/include/texels.glsl"
#include "adit/shaders/shared/limit_probes.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) readonly buffer From { uvec4 from[]; };
layout(set = 0, binding = 1, scalar) writeonly buffer To { uvec4 to[]; };
layout(set = 0, binding = 2) uniform utextureBuffer from_texels;
layout(push_constant, scalar) uniform Push { LimitCopyPush push; };

void main() {
  const uint threads = gl_NumWorkGroups.x * kLocalSize;
  for (uint i = gl_GlobalInvocationID.x; i < push.count; i += threads) {
    to[i] = FETCH(from, i);
  }
}
