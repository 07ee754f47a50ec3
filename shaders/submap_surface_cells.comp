// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Adds the points of a submap to the surface cells that submap_surfaces.comp asks: cells of the
// size that each point's range from its own sensor wants. One thread takes points strided over all
// threads.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#ifdef ADIT_WIDE
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#endif
#include "adit/shaders/shared/gaussian_cell.h"
#include "adit/shaders/shared/submap.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) readonly buffer Cloud { uvec4 cloud[]; };  // w: its sensor
layout(set = 0, binding = 1, scalar) readonly buffer Sensors { vec4 sensors[]; };
layout(set = 0, binding = 2, scalar) buffer Surfaces { GaussianCell surfaces[]; };
layout(push_constant, scalar) uniform Push { SubmapSurfacePush push; };

#include "adit/shaders/include/surface_sums.glsl"

void main() {
  const uint threads = gl_NumWorkGroups.x * kLocalSize;
  for (uint i = gl_GlobalInvocationID.x; i < push.point_count; i += threads) {
    const uvec4 point = cloud[i];
    const vec3 p = uintBitsToFloat(point.xyz);
    const uint level = surface_level(p - sensors[point.w].xyz, push.level_factor);
    add_to_surface(surface_run_of(surface_cell_of_level(p, level, push.inverse_surface_cell)),
                   push.surface_mask);
  }
}
