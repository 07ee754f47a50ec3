// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Describes a place by what stands around it. One thread takes points strided over the group; there
// is one group. Written: the place's record, and its polar view and plan in a block of the index.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/include/plan.glsl"
#include "adit/shaders/include/surface.glsl"
#include "adit/shaders/shared/places.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) readonly buffer Cloud { uvec4 cloud[]; };
layout(set = 0, binding = 1, scalar) writeonly buffer Record { uint record[]; };
layout(set = 0, binding = 2, scalar) writeonly buffer Block { uint block[]; };
layout(push_constant, scalar) uniform Push { DescribePush push; };

shared uint polar[kPolarWords];
shared uint plan[kPlanWords];

// Walls, trunks and poles; of what has no clear surface, what does not lie on the ground.
bool stands(float z, uint surface) {
  const uint kind = surface >> 30;
  const float upwards = abs(unpack_direction(surface).z);
  return is_plane(kind) ? upwards < 0.7 : kind == kLine && upwards > 0.5 ? true : z > kOffGround;
}

uint spread_rings(uint word) { return word | (word << 1) | (word >> 1); }

void main() {
  const uint thread = gl_LocalInvocationID.x;
  for (uint i = thread; i < kPlanWords; i += kLocalSize) {
    plan[i] = 0;
    if (i < kPolarWords) {
      polar[i] = 0;
    }
  }
  barrier();
  for (uint i = thread; i < push.point_count; i += kLocalSize) {
    const uvec4 point = cloud[i];
    const vec3 p = uintBitsToFloat(point.xyz);
    const bool standing = stands(p.z, point.w);
    const uint ring = ring_of(p.xy);
    if (standing && ring < 32u) {
      const uint layer = p.z >= kUpperLayer ? 1u : 0u;
      atomicOr(polar[kPlaceLayers * sector_of(p.xy) + layer], 1u << ring);
    }
    const vec2 scaled = floor(p.xy * push.inverse_cell) + float(kPlanSide / 2);
    if (standing && all(greaterThanEqual(scaled, vec2(0.0))) &&
        all(lessThan(scaled, vec2(kPlanSide)))) {
      const uvec2 at = uvec2(scaled);
      atomicOr(plan[kPlanRow * at.y + (at.x >> 5)], 1u << (at.x & 31u));
    }
  }
  barrier();
  for (uint i = thread; i < kPolarWords; i += kLocalSize) {
    record[i] = polar[i];
    block[i * kBlockPlaces + push.place] = polar[i];
    const uint before = (i + kPolarWords - kPlaceLayers) % kPolarWords;
    const uint after = (i + kPlaceLayers) % kPolarWords;
    record[kSpreadAt + i] = spread_rings(polar[before] | polar[i] | polar[after]);
  }
  for (uint i = thread; i < kPlanWords; i += kLocalSize) {
    record[kPlanAt + i] = plan[i];
    block[kBlockPlansAt + kPlanWords * push.place + i] = plan[i];
  }
}
