// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Voxel down-sampling, pass 3 of 3: writes one point a cell (its centroid; intensity of the cell's
// first point), in the order of the raw points, and frees the cell for the next sweep. A group
// does so for what the same group found in pass 2. Each new point is also added to the surface
// cells that surface_normals.comp will ask; consecutive points share many of these, so a thread
// adds up runs in registers.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#ifdef ADIT_WIDE
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#endif
#include "adit/shaders/include/parts.glsl"
#include "adit/shaders/include/texels.glsl"
#include "adit/shaders/include/wide.glsl"
#include "adit/shaders/shared/gaussian_cell.h"
#include "adit/shaders/shared/preprocess.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;
layout(constant_id = 1) const uint kRun = 32;

// Whether runs are added up first. GPUs have a point or two a thread, and need its registers.
layout(constant_id = 3) const bool kRuns = false;

layout(set = 0, binding = 0, scalar) readonly buffer Raw { uvec4 points[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Firsts { PAIR firsts[]; };
layout(set = 0, binding = 2, scalar) buffer Table { InputCell cells[]; };
layout(set = 0, binding = 3, scalar) readonly buffer ThreadCounts { uint thread_counts[]; };
layout(set = 0, binding = 4, scalar) readonly buffer GroupCounts { uint group_counts[]; };
layout(set = 0, binding = 5, scalar) writeonly buffer Cloud { PAIR cloud[]; };  // two a point
layout(set = 0, binding = 6, scalar) buffer Surfaces { GaussianCell surfaces[]; };
layout(set = 0, binding = 7, scalar) buffer Counters { SweepCounters counters; };
layout(set = 0, binding = 8) uniform utextureBuffer points_texels;
layout(push_constant, scalar) uniform Push { EmitPush push; };

#include "adit/shaders/include/surface_sums.glsl"

// What this group's threads found in pass 2 is one list, which its threads share out evenly.
const uint kBlock = 8;
shared uint counts[kLocalSize];  // of the threads of pass 2
shared uint block_counts[(kLocalSize + kBlock - 1) / kBlock];
shared uint begins[kLocalSize + 1];  // of their items in the list
shared uint group_offset;

void sum_counts(Part part) {
  const uint local = gl_LocalInvocationIndex;
  const uint count = thread_counts[part.index];
  counts[local] = count;
  if (local == 0) {
    group_offset = 0;
  }
  barrier();
  uint within = 0;
  for (uint t = local / kBlock * kBlock; t < local; ++t) {
    within += counts[t];
  }
  if (local % kBlock == kBlock - 1 || local == kLocalSize - 1) {
    block_counts[local / kBlock] = within + count;
  }
  uint before = 0;
  for (uint g = local; g < part.group; g += kLocalSize) {
    before += group_counts[g];
  }
  atomicAdd(group_offset, before);
  barrier();
  for (uint b = 0; b < local / kBlock; ++b) {
    within += block_counts[b];
  }
  begins[local] = within;
  if (local == kLocalSize - 1) {
    begins[kLocalSize] = within + count;
    if (part.group == gl_NumWorkGroups.x - 1) {
      counters.cloud_points = group_offset + within + count;
    }
  }
  barrier();
}

// The thread of pass 2 that found item k.
uint finder_of(uint k) {
  uint low = 0;
  uint high = kLocalSize;
  while (high - low > 1) {
    const uint middle = (low + high) / 2;
    const bool above = begins[middle] <= k;
    low = above ? middle : low;
    high = above ? high : middle;
  }
  return low;
}

// The run that `point` continues or begins; the one that it ends is added to the table. The key
// kFree stands for no run and no point.
SurfaceRun with_point(SurfaceRun run, SurfaceCellId point, inout uint lost) {
  if (!kRuns) {
    if (point.key != kFree) {
      lost += add_to_surface(surface_run_of(point), push.surface_mask);
    }
    return run;
  }
  const bool continues = run.key == point.key;
  if (!continues && run.key != kFree) {
    lost += add_to_surface(run, push.surface_mask);
  }
  const SurfaceRun one = surface_run_of(point);
  return continues ? joined(run, one) : one;
}

// The cell's centroid from its corner, in cells. It is free again for the next sweep.
vec3 taken_mean(uint slot) {
#ifdef ADIT_WIDE
  const uint64_t sum_x = cells[slot].count_sum_x;
  const float count = float(uint(sum_x >> kWideSumBits));
  const u64vec3 sums =
      u64vec3(sum_x & ((uint64_t(1) << kWideSumBits) - 1), cells[slot].sum_y, cells[slot].sum_z);
  const uvec3 low = uvec3(sums);
  const uvec3 high = uvec3(sums >> 32);
  cells[slot].owner = kFree;
  cells[slot].count_sum_x = 0;
  cells[slot].sum_y = 0;
  cells[slot].sum_z = 0;
#else
  const InputCell cell = cells[slot];
  const float count = float(cell.count);
  const uvec3 low = uvec3(cell.sum_x, cell.sum_y, cell.sum_z);
  const uvec3 high =
      uvec3(cell.carries, cell.carries >> kCarryBits, cell.carries >> (2 * kCarryBits)) &
      ((1u << kCarryBits) - 1u);
  cells[slot].owner = kFree;
  cells[slot].count = 0;
  cells[slot].sum_x = 0;
  cells[slot].sum_y = 0;
  cells[slot].sum_z = 0;
  cells[slot].carries = 0;
#endif
  return ((vec3(high) * 4294967296.0 + vec3(low)) / count + 0.5) / 65536.0;
}

void main() {
  const uint blocks = (push.point_count + kRun - 1) / kRun;
  const Part part = part_of_thread(blocks, kLocalSize);
  sum_counts(part);
  const uint items = begins[kLocalSize];
  const uint share = (items + kLocalSize - 1) / kLocalSize;
  const uint begin = min(gl_LocalInvocationIndex * share, items);
  const uint end = min(begin + share, items);
  const uint stride = part_length(blocks, kLocalSize) * kRun;
  uint finder = finder_of(begin);
  uint next = begins[finder + 1];
  uint place = (part.group * kLocalSize + finder) * stride + begin - begins[finder];
  uint lost = 0;
  SurfaceRun own = no_surface_run();
  SurfaceRun wider = no_surface_run();
  for (uint k = begin; k <= end; ++k) {
    SurfaceCellId own_cell = SurfaceCellId(kFree, uvec3(0));
    SurfaceCellId wider_cell = own_cell;
    if (k < end) {
      while (k >= next) {
        finder += 1;
        place = (part.group * kLocalSize + finder) * stride;
        next = begins[finder + 1];
      }
      const uvec2 first = WORDS_OF(firsts[place]);
      place += 1;
      const vec4 raw = uintBitsToFloat(FETCH(points, first.y));
      const vec3 p = (floor(raw.xyz * push.inverse_cell) + taken_mean(first.x)) * push.cell;
      const uvec4 bits = floatBitsToUint(vec4(p, raw.w));
      cloud[2 * (group_offset + k)] = PAIR_OF(bits.xy);
      cloud[2 * (group_offset + k) + 1] = PAIR_OF(bits.zw);
      const uint level = surface_level(p, push.level_factor);
      own_cell = surface_cell_of_level(p, level, push.inverse_surface_cell);
      wider_cell = surface_cell_of_level(p, level + 1, push.inverse_surface_cell);
    }
    own = with_point(own, own_cell, lost);
    wider = with_point(wider, wider_cell, lost);
  }
  if (lost > 0) {
    atomicAdd(counters.surface_failures, lost);
  }
}
