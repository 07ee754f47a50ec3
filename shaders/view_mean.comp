// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// One colour of the sightings of a point. One thread takes a point. The sighting that the others
// are nearest to, by weight, and those nearest to it that make up half of the weight: their mean,
// so that what stood in the way in fewer than half of the images counts for nothing. Written: red
// in the low byte, green, blue, and the number of sightings; 0: there is none.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/shared/coloring.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) readonly buffer Sightings { ColorSighting sightings[]; };
layout(set = 0, binding = 1, scalar) writeonly buffer Colors { uint colors[]; };
layout(push_constant, scalar) uniform Push { MeanPush push; };

ivec3 unpack(uint color) { return ivec3(color & 255u, (color >> 8) & 255u, (color >> 16) & 255u); }

int difference(uint a, uint b) {
  const ivec3 d = abs(unpack(a) - unpack(b));
  return d.x + d.y + d.z;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.point_count) {
    return;
  }
  const uint first = i * kMostSightings;
  float whole = 0.0;
  uint count = 0;
  uint middle = 0;
  float least = 0.0;
  for (uint k = 0; k < kMostSightings; ++k) {
    const ColorSighting one = sightings[first + k];
    if (one.weight > 0.0) {
      float sum = 0.0;
      for (uint j = 0; j < kMostSightings; ++j) {
        const ColorSighting other = sightings[first + j];
        sum += other.weight * float(difference(one.color, other.color));
      }
      if (count == 0 || sum < least) {
        middle = one.color;
        least = sum;
      }
      whole += one.weight;
      ++count;
    }
  }
  // From the nearest on; of equals the first.
  vec3 sum = vec3(0.0);
  float taken = 0.0;
  int last = -1;
  for (uint round = 0; round < kMostSightings && 2.0 * taken < whole; ++round) {
    int next = 1000;
    for (uint k = 0; k < kMostSightings; ++k) {
      const ColorSighting one = sightings[first + k];
      const int away = difference(one.color, middle);
      next = one.weight > 0.0 && away > last ? min(next, away) : next;
    }
    for (uint k = 0; k < kMostSightings; ++k) {
      const ColorSighting one = sightings[first + k];
      if (one.weight > 0.0 && difference(one.color, middle) == next) {
        sum += one.weight * vec3(unpack(one.color));
        taken += one.weight;
      }
    }
    last = next;
  }
  const uvec3 mean = count == 0 ? uvec3(0) : uvec3(sum / taken + 0.5);
  colors[i] = mean.x | (mean.y << 8) | (mean.z << 16) | (count << 24);
}
