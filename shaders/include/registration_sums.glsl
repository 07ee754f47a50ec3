// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Adding the matches of points up to H, g and what comes with them.
#ifndef ADIT_REGISTRATION_SUMS_GLSL
#define ADIT_REGISTRATION_SUMS_GLSL
#include "adit/shaders/include/registration_match.glsl"

// Adds the matches of a point: e = mean - (R a + t), de/drho = -I, de/dphi = [R a]x with ra = R a.
void accumulate(inout float sums[kSums], vec3 ra, Pull pull) {
  const vec3 ox = vec3(pull.omega.xx, pull.omega.xy, pull.omega.xz);
  const vec3 oy = vec3(pull.omega.xy, pull.omega.yy, pull.omega.yz);
  const vec3 oz = vec3(pull.omega.xz, pull.omega.yz, pull.omega.zz);
  const vec3 oe = pull.force;
  // Omega [ra]x, rows; H_tr = -Omega [ra]x, H_rr = -[ra]x Omega [ra]x.
  const vec3 ax = cross(ox, ra);
  const vec3 ay = cross(oy, ra);
  const vec3 az = cross(oz, ra);
  sums[0] += ox.x;
  sums[1] += ox.y;
  sums[2] += ox.z;
  sums[3] -= ax.x;
  sums[4] -= ax.y;
  sums[5] -= ax.z;
  sums[6] += oy.y;
  sums[7] += oy.z;
  sums[8] -= ay.x;
  sums[9] -= ay.y;
  sums[10] -= ay.z;
  sums[11] += oz.z;
  sums[12] -= az.x;
  sums[13] -= az.y;
  sums[14] -= az.z;
  sums[15] -= ra.y * az.x - ra.z * ay.x;
  sums[16] -= ra.y * az.y - ra.z * ay.y;
  sums[17] -= ra.y * az.z - ra.z * ay.z;
  sums[18] -= ra.z * ax.y - ra.x * az.y;
  sums[19] -= ra.z * ax.z - ra.x * az.z;
  sums[20] -= ra.x * ay.z - ra.y * ax.z;
  sums[21] -= oe.x;
  sums[22] -= oe.y;
  sums[23] -= oe.z;
  const vec3 gr = cross(ra, oe);
  sums[24] -= gr.x;
  sums[25] -= gr.y;
  sums[26] -= gr.z;
  sums[kCostAt] += pull.cost;
  sums[kSquaredAt] += pull.squared;
  sums[kInliersAt] += pull.matches > 0 ? 1.0 : 0.0;
  sums[kMatchesAt] += float(pull.matches);
  if (kGeometry) {
    const vec3 wra = pull.weight * ra;
    const vec3 turn = cross(ra, pull.drift);
    const uint at = kSums - 16;  // kGeometryAt, and within the array for any kSums
    sums[at] += pull.weight;
    sums[at + 1] += wra.x;
    sums[at + 2] += wra.y;
    sums[at + 3] += wra.z;
    sums[at + 4] += wra.x * ra.x;
    sums[at + 5] += wra.x * ra.y;
    sums[at + 6] += wra.x * ra.z;
    sums[at + 7] += wra.y * ra.y;
    sums[at + 8] += wra.y * ra.z;
    sums[at + 9] += wra.z * ra.z;
    sums[at + 10] += pull.drift.x;
    sums[at + 11] += pull.drift.y;
    sums[at + 12] += pull.drift.z;
    sums[at + 13] += turn.x;
    sums[at + 14] += turn.y;
    sums[at + 15] += turn.z;
  }
}

#endif
