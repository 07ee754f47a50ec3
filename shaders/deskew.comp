// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Moves each point of a sweep to where it would have been seen at the sweep's start. One thread
// takes every so many points. The sensor's pose at a point's time lies between two knots: positions
// linearly, rotations by normalised linear interpolation. Written: as many points; what is not
// finite, has no finite time, or lies outside of c_min to c_max as it was measured becomes
// (0, 0, 0): no return.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/include/hash.glsl"
#include "adit/shaders/include/texels.glsl"
#include "adit/shaders/shared/deskew.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) readonly buffer Raw {
  uvec4 points[];
};  // bits of x, y, z, intensity
layout(set = 0, binding = 1, scalar) readonly buffer Times { float times[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Knots {
  uvec4 knots[];
};  // DeskewKnot: 2 each
layout(set = 0, binding = 3, scalar) writeonly buffer Moved { vec4 moved[]; };
layout(set = 0, binding = 4) uniform utextureBuffer points_texels;
layout(set = 0, binding = 5) uniform utextureBuffer knots_texels;
layout(push_constant, scalar) uniform Push { DeskewPush push; };

vec3 rotate(vec4 q, vec3 v) {
  const vec3 t = 2.0 * cross(q.xyz, v);
  return v + q.w * t + cross(q.xyz, t);
}

vec4 knot(uint i) { return uintBitsToFloat(FETCH(knots, i)); }

vec3 at_start(vec3 p, float time) {
  const float place = clamp((time - push.first_time) * push.per_second, 0.0, float(push.knots - 1));
  const uint k = min(uint(place), push.knots - 2);
  const float share = place - float(k);
  const vec4 q = mix(knot(2 * k), knot(2 * k + 2), share);
  const vec3 t = mix(knot(2 * k + 1).xyz, knot(2 * k + 3).xyz, share);
  return rotate(q * inversesqrt(dot(q, q)), p) + t;
}

void main() {
  const uint stride = gl_NumWorkGroups.x * kLocalSize;
  for (uint i = gl_GlobalInvocationID.x; i < push.point_count; i += stride) {
    const vec4 point = uintBitsToFloat(FETCH(points, i));
    const float time = times[i];
    const float squared = dot(point.xyz, point.xyz);
    const bool valid = is_finite(point.xyz) && is_finite(vec3(time)) &&
                       squared >= push.min_squared && squared <= push.max_squared;
    moved[i] = vec4(valid ? at_start(point.xyz, time) : vec3(0.0), point.w);
  }
}
