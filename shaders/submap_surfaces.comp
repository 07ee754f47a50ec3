// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Estimates the surface at each point of a submap from the surface cell it lies in. One thread
// takes points strided over all threads. Written: the point with its packed surface, whose normal
// looks towards the sensor that saw the point.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/include/surface_estimate.glsl"
#include "adit/shaders/shared/submap.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) readonly buffer Cloud { uvec4 cloud[]; };  // w: its sensor
layout(set = 0, binding = 1, scalar) readonly buffer Sensors { vec4 sensors[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Surfaces {
  uvec4 surfaces[];
};  // GaussianCell: 3 each
layout(set = 0, binding = 3, scalar) writeonly buffer Output { uvec4 surface_cloud[]; };
layout(push_constant, scalar) uniform Push { SubmapSurfacePush push; };

void main() {
  const uint threads = gl_NumWorkGroups.x * kLocalSize;
  for (uint i = gl_GlobalInvocationID.x; i < push.point_count; i += threads) {
    const uvec4 point = cloud[i];
    const vec3 p = uintBitsToFloat(point.xyz);
    const vec3 ray = p - sensors[point.w].xyz;
    const uint level = surface_level(ray, push.level_factor);
    const uint key = surface_cell_of_level(p, level, push.inverse_surface_cell).key;
    uint slot = mix32(key) & push.surface_mask;
    uint probes = 0;
    uvec4 head = surfaces[3 * slot];
    while (head.x != key && head.x != kFree && probes < kMaxProbes) {
      slot = (slot + 1) & push.surface_mask;
      head = surfaces[3 * slot];
      probes += 1;
    }
    const SurfaceMoments moments =
        moments_of(head, surfaces[3 * slot + 1], surfaces[3 * slot + 2], vec3(0.0));
    const bool whole = head.x == key && head.y <= kMostCellPoints;
    const uint packed =
        whole ? surface_of(moments, ray, beam_gap(ray, level, push.level_factor), false)
              : no_surface();
    surface_cloud[i] = uvec4(point.xyz, packed);
  }
}
