// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Adds points to the cells that surfaces are estimated from. Whoever includes this has declared the
// buffer `GaussianCell surfaces[]`.
#ifndef ADIT_SURFACE_SUMS_GLSL
#define ADIT_SURFACE_SUMS_GLSL
#include "adit/shaders/include/surface.glsl"

// False where the point found no slot, or its cell is beyond kMostCellPoints and shows no surface.
bool add_to_surface(SurfaceCellId id, uint mask) {
  uint slot = mix32(id.key) & mask;
  uint probes = 0;
  bool found = false;
  uint before = 0;
  while (!found && probes < kMaxProbes) {
    const uint key = atomicCompSwap(surfaces[slot].key, kFree, id.key);
    found = key == kFree || key == id.key;
    slot = found ? slot : (slot + 1) & mask;
    probes += 1;
  }
  if (found) {
    const uvec3 o = id.offset;
    const uvec3 x = (o * o.x + 32768) >> 16;  // xx, xy, xz
    const uvec3 y = (o * o.y + 32768) >> 16;  // xy, yy, yz
    before = atomicAdd(surfaces[slot].count, 1);
    atomicAdd(surfaces[slot].sum_x, o.x);
    atomicAdd(surfaces[slot].sum_y, o.y);
    atomicAdd(surfaces[slot].sum_z, o.z);
    atomicAdd(surfaces[slot].xx, x.x);
    atomicAdd(surfaces[slot].xy, x.y);
    atomicAdd(surfaces[slot].xz, x.z);
    atomicAdd(surfaces[slot].yy, y.y);
    atomicAdd(surfaces[slot].yz, y.z);
    atomicAdd(surfaces[slot].zz, (o.z * o.z + 32768) >> 16);
  }
  return found && before < kMostCellPoints;
}

#endif
