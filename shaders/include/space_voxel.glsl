// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A tile's voxels by their place. Whoever includes it has the buffer `voxels` and the push.
#ifndef ADIT_SPACE_VOXEL_GLSL
#define ADIT_SPACE_VOXEL_GLSL

#include "adit/shaders/include/hash.glsl"

const uint kNoVoxel = 0xffffffffu;

// The slot of a voxel that holds points; kNoVoxel: none is there.
uint slot_of(ivec3 voxel) {
  const uint key = pack_voxel(voxel);
  uint slot = mix32(key) & push.table_mask;
  uint found = voxels[slot].key;
  uint probes = 0;
  while (found != key && found != kFree && probes < kMaxProbes) {
    slot = (slot + 1) & push.table_mask;
    found = voxels[slot].key;
    probes += 1;
  }
  return found == key && key != kFree ? slot : kNoVoxel;
}

#endif
