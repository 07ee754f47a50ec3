// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Measures how fast a device reads records of 64 bytes at random places, as look-ups of voxels do.
// One thread takes reads strided over all threads and writes the exclusive or of all it read.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/include/hash.glsl"
#include "adit/shaders/include/texels.glsl"
#include "adit/shaders/shared/limit_probes.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) readonly buffer Table { uvec4 table[]; };
layout(set = 0, binding = 1, scalar) writeonly buffer Results { uvec4 results[]; };
layout(set = 0, binding = 2) uniform utextureBuffer table_texels;
layout(push_constant, scalar) uniform Push { LimitGatherPush push; };

void main() {
  const uint threads = gl_NumWorkGroups.x * kLocalSize;
  uvec4 all = uvec4(0);
  for (uint i = gl_GlobalInvocationID.x; i < push.count; i += threads) {
    const uint at = kRecordQuads * (mix32(i) & push.mask);
    all ^= FETCH(table, at) ^ FETCH(table, at + 1) ^ FETCH(table, at + 2) ^ FETCH(table, at + 3);
  }
  results[gl_GlobalInvocationID.x] = all;
}
