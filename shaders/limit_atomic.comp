// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Measures how fast a device adds to random places, as kernels that fill tables do: one thread
// takes additions of one strided over all threads.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/include/hash.glsl"
#include "adit/shaders/shared/limit_probes.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) buffer Table { uint table[]; };
layout(push_constant, scalar) uniform Push { LimitScatterPush push; };

void main() {
  const uint threads = gl_NumWorkGroups.x * kLocalSize;
  for (uint i = gl_GlobalInvocationID.x; i < push.count; i += threads) {
    atomicAdd(table[mix32(i) & push.mask], 1u);
  }
}
