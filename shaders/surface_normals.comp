// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Estimates the surface at each point of the down-sampled cloud from the second moments of the
// surface cell it lies in; where that shows none, of the eight cells around the point, and then of
// eight that are twice as wide. One thread takes points strided over all threads. Written: the
// point with its packed surface (normal towards the sensor, or direction, and class) in place of
// the intensity.
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
layout(set = 0, binding = 3, scalar) readonly buffer Counters { SweepCounters counters; };
layout(set = 0, binding = 4) uniform utextureBuffer cloud_texels;
layout(set = 0, binding = 5) uniform utextureBuffer surfaces_texels;
layout(push_constant, scalar) uniform Push { SurfacePush push; };

const uint kNoSlot = 0xffffffffu;

// The slot of a cell, or kNoSlot where there is none, or its sums may have overflowed.
uint slot_of(uint key) {
  uint slot = mix32(key) & push.surface_mask;
  uint probes = 0;
  uvec2 head = FETCH(surfaces, 3 * slot).xy;
  while (head.x != key && head.x != kFree && probes < kMaxProbes) {
    slot = (slot + 1) & push.surface_mask;
    head = FETCH(surfaces, 3 * slot).xy;
    probes += 1;
  }
  return head.x == key && head.y <= kMostCellPoints ? slot : kNoSlot;
}

SurfaceMoments moments_at(uint slot, ivec3 shift) {
  return moments_of(FETCH(surfaces, 3 * slot), FETCH(surfaces, 3 * slot + 1),
                    FETCH(surfaces, 3 * slot + 2), vec3(shift));
}

// The point's cell and those on the sides to which it lies nearer.
uint surface_around(vec3 p, uint level) {
  const SurfaceCellId id = surface_cell_of_level(p, level, push.inverse_surface_cell);
  const ivec3 side = 2 * ivec3(greaterThanEqual(id.offset, uvec3(32768))) - 1;
  SurfaceMoments sum = no_moments();
  for (uint i = 0; i < 8; ++i) {
    const ivec3 shift = side * ivec3(i & 1u, (i >> 1) & 1u, i >> 2);
    const uint slot = slot_of(neighbour_of(id.key, shift));
    if (slot != kNoSlot) {
      sum = together(sum, moments_at(slot, shift));
    }
  }
  return surface_of(sum, p, 0.0, true);
}

bool is_none(uint packed) { return (packed >> 30) == kIsotropic; }

// Software devices run what any lane of a subgroup takes in all of them. So a thread looks around
// the few points that need it in loops of their own.
const uint kShare = 32;

// The points of which `left` has a bit, the j-th of them at begin + j * threads; `wider` levels up.
// Bits of those that show nothing there, either.
uint look_around(uint left, uint begin, uint threads, uint wider) {
  uint nothing = 0;
  while (left != 0) {
    const uint j = uint(findLSB(left));
    const uint i = begin + j * threads;
    const vec3 p = uintBitsToFloat(FETCH(cloud, i).xyz);
    const uint packed = surface_around(p, surface_level(p, push.level_factor) + wider);
    surface_cloud[i].w = packed;
    nothing |= is_none(packed) ? 1u << j : 0u;
    left &= left - 1u;
  }
  return nothing;
}

void main() {
  const uint count = counters.cloud_points;
  const uint threads = gl_NumWorkGroups.x * kLocalSize;
  for (uint begin = gl_GlobalInvocationID.x; begin < count; begin += kShare * threads) {
    const uint points = min((count - begin + threads - 1) / threads, kShare);
    uint nothing = 0;
    for (uint j = 0; j < points; ++j) {
      const uint i = begin + j * threads;
      const vec3 p = uintBitsToFloat(FETCH(cloud, i).xyz);
      const uint level = surface_level(p, push.level_factor);
      const SurfaceCellId own = surface_cell_of_level(p, level, push.inverse_surface_cell);
      const uint slot = slot_of(own.key);
      const uint packed = slot == kNoSlot
                              ? no_surface()
                              : surface_of(moments_at(slot, ivec3(0)), p,
                                           beam_gap(p, level, push.level_factor), false);
      surface_cloud[i] = uvec4(floatBitsToUint(p), packed);
      nothing |= is_none(packed) ? 1u << j : 0u;
    }
    nothing = look_around(nothing, begin, threads, 0);
    look_around(nothing, begin, threads, 1);
  }
}
