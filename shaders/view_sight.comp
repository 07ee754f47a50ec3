// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The colours of points in one image. One thread takes a point. Written: the point's sightings, of
// which the sharpest kMostSightings stay.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/shared/coloring.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) readonly buffer Points { vec3 points[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Lens { float lens_radii[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Depth { uint depth[]; };
layout(set = 0, binding = 3, scalar) readonly buffer Image { uint image[]; };
layout(set = 0, binding = 4, scalar) buffer Sightings { ColorSighting sightings[]; };
layout(push_constant, scalar) uniform Push { SightPush push; };

#include "adit/shaders/include/camera.glsl"

// 1/m; 0 where nothing is seen.
float nearness(ivec2 at) {
  const ivec2 inside = clamp(at, ivec2(0), ivec2(push.depth_width, push.depth_height) - 1);
  const uint seen = depth[uint(inside.y) * push.depth_width + uint(inside.x)];
  return seen == kNoDepth ? 0.0 : 1.0 / uintBitsToFloat(seen);
}

// Of the surface there: along a plane 1/m is all but linear in the pixels.
float nearness_at(vec2 pixel) {
  const vec2 place = (pixel + 0.5) / push.pixels - 0.5;
  const ivec2 at = ivec2(floor(place));
  const vec2 part = place - vec2(at);
  return mix(mix(nearness(at), nearness(at + ivec2(1, 0)), part.x),
             mix(nearness(at + ivec2(0, 1)), nearness(at + ivec2(1, 1)), part.x), part.y);
}

vec3 color_of(ivec2 at) {
  const ivec2 inside = clamp(at, ivec2(0), ivec2(push.camera.width, push.camera.height) - 1);
  const uint packed = image[uint(inside.y) * push.camera.width + uint(inside.x)];
  return vec3(packed & 255u, (packed >> 8) & 255u, (packed >> 16) & 255u);
}

vec3 color_at(vec2 pixel) {
  const ivec2 at = ivec2(floor(pixel));
  const vec2 part = pixel - vec2(at);
  return mix(mix(color_of(at), color_of(at + ivec2(1, 0)), part.x),
             mix(color_of(at + ivec2(0, 1)), color_of(at + ivec2(1, 1)), part.x), part.y);
}

uint pack(vec3 color) {
  const uvec3 rounded = uvec3(min(color * push.gain, vec3(255.0)) + 0.5);
  return rounded.x | (rounded.y << 8) | (rounded.z << 16);
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.point_count) {
    return;
  }
  const vec3 p = vec4(points[i], 1.0) * push.camera.T_camera_local;
  const float range = length(p);
  const Pixel pixel = pixel_of(push.camera, p);
  const vec2 last = vec2(push.camera.width, push.camera.height) - 0.5;
  if (!pixel.seen || any(lessThan(pixel.at, vec2(-0.5))) || any(greaterThan(pixel.at, last))) {
    return;
  }
  const float near = nearness_at(pixel.at);
  if (!((range - push.tolerance) * near <= 1.0) || near == 0.0) {
    return;
  }
  const vec3 color = color_at(pixel.at);
  const bool saturated = max(max(color.x, color.y), color.z) > float(kBrightest);
  const float weight =
      push.camera.fx * push.camera.fy / (range * range) * (saturated ? kSaturatedWorth : 1.0);
  const uint first = i * kMostSightings;
  uint least = 0;
  float least_weight = sightings[first].weight;
  for (uint k = 1; k < kMostSightings; ++k) {
    const float other = sightings[first + k].weight;
    if (other < least_weight) {
      least = k;
      least_weight = other;
    }
  }
  if (weight > least_weight) {
    sightings[first + least] = ColorSighting(pack(color), weight);
  }
}
