// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Adds points to the cells that surfaces are estimated from. Whoever includes this has declared the
// buffer `GaussianCell surfaces[]`.
#ifndef ADIT_SURFACE_SUMS_GLSL
#define ADIT_SURFACE_SUMS_GLSL
#include "adit/shaders/include/surface.glsl"
#include "adit/shaders/include/wide.glsl"

// What consecutive points of one surface cell add to it: fewer than 2^16 of them.
struct SurfaceRun {
  uint key;  // kFree: no point yet
  uint count;
  uvec3 sum;
  uvec3 x;  // xx, xy, xz
  uvec2 y;  // yy, yz
  uint zz;
};

SurfaceRun no_surface_run() { return SurfaceRun(kFree, 0, uvec3(0), uvec3(0), uvec2(0), 0); }

SurfaceRun surface_run_of(SurfaceCellId id) {
  const uvec3 o = id.offset;
  return SurfaceRun(id.key, 1, o, (o * o.x + 32768) >> 16, (o.yz * o.y + 32768) >> 16,
                    (o.z * o.z + 32768) >> 16);
}

// Of two runs of one cell.
SurfaceRun joined(SurfaceRun a, SurfaceRun b) {
  return SurfaceRun(a.key, a.count + b.count, a.sum + b.sum, a.x + b.x, a.y + b.y, a.zz + b.zz);
}

// How many of its points were lost: found no slot, or are beyond kMostCellPoints, so that their
// cell shows no surface.
uint add_to_surface(SurfaceRun run, uint mask) {
  uint slot = mix32(run.key) & mask;
  uint probes = 0;
  bool found = false;
  while (!found && probes < kMaxProbes) {
    const uint key = atomicCompSwap(surfaces[slot].key, kFree, run.key);
    found = key == kFree || key == run.key;
    slot = found ? slot : (slot + 1) & mask;
    probes += 1;
  }
  if (!found) {
    return run.count;
  }
  const uint count = atomicAdd(surfaces[slot].count, run.count) + run.count;
  ADD_PAIR(surfaces[slot], sum_x, sum_y, run.sum.xy);
  ADD_PAIR(surfaces[slot], sum_z, xx, uvec2(run.sum.z, run.x.x));
  ADD_PAIR(surfaces[slot], xy, xz, run.x.yz);
  ADD_PAIR(surfaces[slot], yy, yz, run.y);
  ADD_LOW(surfaces[slot], zz, surfaces, run.zz);
  return count > kMostCellPoints ? min(count - kMostCellPoints, run.count) : 0;
}

#endif
