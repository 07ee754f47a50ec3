// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Estimates the surface at each point of the down-sampled cloud from the second moments of the
// surface cell it lies in. One thread takes points strided over all threads. Written: the point
// with its packed surface (normal towards the sensor, or direction, and class) in place of the
// intensity.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/include/surface_estimate.glsl"
#include "adit/shaders/include/texels.glsl"
#include "adit/shaders/shared/preprocess.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) readonly buffer Cloud { uvec4 cloud[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Surfaces {
  uvec4 surfaces[];
};  // GaussianCell: 3 each
layout(set = 0, binding = 2, scalar) writeonly buffer Output { uvec4 surface_cloud[]; };
layout(set = 0, binding = 3, scalar) buffer Counters { SweepCounters counters; };
layout(set = 0, binding = 4) uniform utextureBuffer cloud_texels;
layout(set = 0, binding = 5) uniform utextureBuffer surfaces_texels;
layout(push_constant, scalar) uniform Push { SurfacePush push; };

void main() {
  const uint count = counters.cloud_points;
  const uint threads = gl_NumWorkGroups.x * kLocalSize;
  for (uint i = gl_GlobalInvocationID.x; i < count; i += threads) {
    const vec3 p = uintBitsToFloat(FETCH(cloud, i).xyz);
    const uint key = surface_cell(p, push.inverse_surface_cell, push.level_factor).key;
    uint slot = mix32(key) & push.surface_mask;
    uint probes = 0;
    uvec4 head = FETCH(surfaces, 3 * slot);
    while (head.x != key && head.x != kFree && probes < kMaxProbes) {
      slot = (slot + 1) & push.surface_mask;
      head = FETCH(surfaces, 3 * slot);
      probes += 1;
    }
    uint packed = no_surface();
    if (head.x != key) {
      atomicAdd(counters.surface_failures, 1);
    } else {
      packed = surface_of(head, FETCH(surfaces, 3 * slot + 1), FETCH(surfaces, 3 * slot + 2), p);
    }
    surface_cloud[i] = uvec4(floatBitsToUint(p), packed);
  }
}
