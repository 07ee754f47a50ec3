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

void main() {
  const uint place = gl_GlobalInvocationID.x;
  if (place >= push.place_count) {
    return;
  }
  uint best = 0;
  for (uint turn = 0; turn < kPlaceSectors; ++turn) {
    uint hits = 0;
    for (uint sector = 0; sector < kPlaceSectors; ++sector) {
      const uint word = kPlaceLayers * sector;
      const uint seen = kPlaceLayers * ((sector + turn) % kPlaceSectors);
      for (uint layer = 0; layer < kPlaceLayers; ++layer) {
        const uint bits = block[(word + layer) * kBlockPlaces + place];
        hits += bitCount(bits & record[kSpreadAt + seen + layer]) +
                bitCount(bits & record[seen + layer]);
      }
    }
    best = max(best, hits * kPlaceSectors + turn);
  }
  matches[place] = best;
}
