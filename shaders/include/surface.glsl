// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The local surface at a point: a direction and its class, packed into 32 bits, and the constraint
// matrix P = alpha I + beta v v^T it stands for. VGICP's regularised covariance is C = I - (1 -
// epsilon) P.
#ifndef ADIT_SURFACE_GLSL
#define ADIT_SURFACE_GLSL
#include "adit/shaders/include/hash.glsl"

const uint kIsotropic = 0u;  // P = 0: hardly any constraint
const uint kPlane = 1u;      // v the normal, P = v v^T
const uint kLine = 2u;       // v the direction, P = I - v v^T
const uint kGrazing = 3u;    // a plane seen edge-on: noise decides which way v faces

bool is_plane(uint kind) { return (kind & 1u) != 0u; }

// Octahedral map of a unit vector, 15 bits an axis (0.005 degrees); the class in the two top bits.
uint pack_surface(vec3 v, uint kind) {
  vec2 o = v.xy / (abs(v.x) + abs(v.y) + abs(v.z));
  const vec2 folded =
      (1.0 - abs(o.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(o, vec2(0.0)));
  o = v.z < 0.0 ? folded : o;
  const uvec2 q = uvec2(clamp(o * 16383.0 + 16383.5, 0.0, 32766.0));
  return (kind << 30) | (q.x << 15) | q.y;
}

vec3 unpack_direction(uint packed) {
  const vec2 o = (vec2((packed >> 15) & 0x7fffu, packed & 0x7fffu) - 16383.0) / 16383.0;
  vec3 v = vec3(o, 1.0 - abs(o.x) - abs(o.y));
  const vec2 folded =
      (1.0 - abs(v.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(v.xy, vec2(0.0)));
  v.xy = v.z < 0.0 ? folded : v.xy;
  return normalize(v);
}

// (alpha, beta) of the packed class.
vec2 surface_weights(uint packed) {
  const uint kind = packed >> 30;
  return vec2(kind == kLine ? 1.0 : 0.0, is_plane(kind) ? 1.0 : (kind == kLine ? -1.0 : 0.0));
}

// Surface cells double in size until they span the gap between neighbouring beams at the point's
// range: level = ceil(log2(range * beam_spacing / r_input)), at least 0; from the exponent of the
// square.
uint surface_level(vec3 p, float level_factor) {
  precise float squared = p.x * p.x + p.y * p.y + p.z * p.z;
  precise float ratio = squared * level_factor;
  const uint bits = floatBitsToUint(max(ratio, 1.0));
  const uint ceil_log2 = (bits >> 23) - 127u + ((bits & 0x7fffffu) != 0u ? 1u : 0u);
  return min((ceil_log2 + 1u) >> 1, 14u);
}

// The square of the gap between neighbouring beams at the end of a ray, in cells of the level;
// level_factor is of 2.5 gaps.
float beam_gap(vec3 ray, uint level, float level_factor) {
  const float cell = uintBitsToFloat((127u - level) << 23);
  return dot(ray, ray) * level_factor * 0.16 * cell * cell;
}

struct SurfaceCellId {
  uint key;
  uvec3 offset;  // the point's, 1/65536 of the cell's edge
};

// 4 bits of level and 9 bits an axis: a cell is at least 2.5 beam spacings wide, so the point's
// coordinates in cells stay below 1 / (2.5 * beam_spacing), which the configuration keeps below
// 256.
SurfaceCellId surface_cell_of_level(vec3 p, uint level, float inverse_surface_cell) {
  const vec3 scaled = p * (inverse_surface_cell * uintBitsToFloat((127u - level) << 23));
  const vec3 corner = floor(scaled);
  const uvec3 biased = uvec3(ivec3(corner) + 256) & 511u;
  return SurfaceCellId(((level << 27) | (biased.x << 18) | (biased.y << 9) | biased.z) + 1u,
                       fixed_offset(scaled, corner));
}

// The key of the cell of the same level that lies `shift` cells away.
uint neighbour_of(uint key, ivec3 shift) {
  const uint packed = key - 1u;
  const uvec3 corner = (uvec3(packed >> 18, packed >> 9, packed) + uvec3(shift)) & 511u;
  return ((packed & 0x78000000u) | (corner.x << 18) | (corner.y << 9) | corner.z) + 1u;
}

#endif
