// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How far away the nearest surface is in each pixel of a view. One thread takes surfaces strided
// over all threads; each is a disc, and a pixel that looks at it gets the least of the distances.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/include/surface.glsl"
#include "adit/shaders/shared/coloring.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) readonly buffer Surfaces { ViewSurface surfaces[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Lens { float lens_radii[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Rays { vec3 rays[]; };  // of depth's pixels
layout(set = 0, binding = 3, scalar) buffer Depth { uint depth[]; };
layout(push_constant, scalar) uniform Push { DepthPush push; };

#include "adit/shaders/include/camera.glsl"

ivec2 depth_pixel(vec2 at) { return ivec2(floor((at + 0.5) / push.pixels)); }

// Pixels of the depth image to either side of the disc's middle that look at it.
int reach_of(vec3 c, float range, vec2 middle) {
  const vec3 toward = c / range;
  const vec3 axis = abs(toward.z) < 0.7 ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0);
  const vec3 u = normalize(cross(toward, axis));
  const vec3 v = cross(toward, u);
  const Pixel right = pixel_of(push.camera, c + push.radius * u);
  const Pixel down = pixel_of(push.camera, c + push.radius * v);
  const float most = max(right.seen ? distance(right.at, middle) : 0.0,
                         down.seen ? distance(down.at, middle) : 0.0);
  return min(int(most / push.pixels) + 1, kMostSplat);
}

void see(vec3 c, vec3 normal, float range, ivec2 at) {
  if (any(lessThan(at, ivec2(0))) ||
      any(greaterThanEqual(at, ivec2(push.depth_width, push.depth_height)))) {
    return;
  }
  const uint index = uint(at.y) * push.depth_width + uint(at.x);
  const vec3 ray = rays[index];  // zero where the lens has none
  const float facing = dot(normal, ray);
  if (facing == 0.0) {
    return;
  }
  const float along = dot(normal, c) / facing;
  const vec3 aside = along * ray - c;
  if (along > 0.0 && dot(aside, aside) <= push.radius * push.radius) {
    atomicMin(depth[index], floatBitsToUint(along));
  }
}

void main() {
  const uint threads = gl_NumWorkGroups.x * kLocalSize;
  for (uint i = gl_GlobalInvocationID.x; i < push.surface_count; i += threads) {
    const vec3 c = vec4(surfaces[i].p, 1.0) * push.camera.T_camera_local;
    const float range = length(c);
    const Pixel middle = pixel_of(push.camera, c);
    if (!middle.seen || range <= push.radius) {
      continue;
    }
    const int reach = reach_of(c, range, middle.at);
    const ivec2 at = depth_pixel(middle.at);
    if (any(lessThan(at + reach, ivec2(0))) ||
        any(greaterThanEqual(at - reach, ivec2(push.depth_width, push.depth_height)))) {
      continue;
    }
    const uint surface = surfaces[i].surface;
    const vec3 normal = surface >> 30 == kPlane
                            ? vec4(unpack_direction(surface), 0.0) * push.camera.T_camera_local
                            : c / range;
    // A disc that is seen edge-on covers no pixel's middle; something is there all the same.
    if (all(greaterThanEqual(at, ivec2(0))) &&
        all(lessThan(at, ivec2(push.depth_width, push.depth_height)))) {
      atomicMin(depth[uint(at.y) * push.depth_width + uint(at.x)], floatBitsToUint(range));
    }
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        see(c, normal, range, at + ivec2(x, y));
      }
    }
  }
}
