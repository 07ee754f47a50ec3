// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Holds the polar view of one place against those of a block of the index, turned by every number
// of sectors. One thread takes one place, one group as many as it has threads. Written: for each
// place the most bits that fall on those of the view (once more for those that are exactly on one),
// and the turn that has them.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/shared/places.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) readonly buffer Record { uint record[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Block { uint block[]; };
layout(set = 0, binding = 2, scalar) writeonly buffer Matches { uint matches[]; };
layout(push_constant, scalar) uniform Push { MatchPush push; };

// Words of the record, each a sector on from the one before.
struct Window {
  uvec4 low, high;
};
const uint kWindow = 8;

Window window_from(uint first, uint sector) {
  uint words[kWindow];
  for (uint i = 0; i < kWindow; ++i) {
    words[i] = record[first + kPlaceLayers * ((sector + i) % kPlaceSectors)];
  }
  return Window(uvec4(words[0], words[1], words[2], words[3]),
                uvec4(words[4], words[5], words[6], words[7]));
}

Window moved_on(Window window, uint next) {
  return Window(uvec4(window.low.yzw, window.high.x), uvec4(window.high.yzw, next));
}

// Eight turns at a time: a word of the place is read once for them, one of the record stays for
// eight sectors.
void main() {
  const uint place = gl_GlobalInvocationID.x;
  if (place >= push.place_count) {
    return;
  }
  uvec4 best = uvec4(0);
  for (uint turn = 0; turn < kPlaceSectors; turn += kWindow) {
    uvec4 low = uvec4(0);
    uvec4 high = uvec4(0);
    for (uint layer = 0; layer < kPlaceLayers; ++layer) {
      Window exact = window_from(layer, turn);
      Window spread = window_from(kSpreadAt + layer, turn);
      for (uint sector = 0; sector < kPlaceSectors; ++sector) {
        const uint bits = block[(kPlaceLayers * sector + layer) * kBlockPlaces + place];
        low += uvec4(bitCount(bits & exact.low) + bitCount(bits & spread.low));
        high += uvec4(bitCount(bits & exact.high) + bitCount(bits & spread.high));
        const uint next = kPlaceLayers * ((sector + turn + kWindow) % kPlaceSectors) + layer;
        exact = moved_on(exact, record[next]);
        spread = moved_on(spread, record[kSpreadAt + next]);
      }
    }
    const uvec4 turns = turn + uvec4(0, 1, 2, 3);
    best = max(best, max(low * kPlaceSectors + turns, high * kPlaceSectors + turns + 4));
  }
  matches[place] = max(max(best.x, best.y), max(best.z, best.w));
}
