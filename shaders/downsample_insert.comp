// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Voxel down-sampling, pass 1 of 3: gathers the raw points of a sweep into a hash grid of cells of
// edge r_input. One thread takes kRun consecutive points (a block); neighbours along a beam share
// cells, so it adds up runs in registers and touches the table once a run. Written: the cells'
// integer sums and owners, and of each block the runs that owned their cells for a while: how many,
// and each one's cell.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#ifdef ADIT_WIDE
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#endif
#include "adit/shaders/include/hash.glsl"
#include "adit/shaders/include/texels.glsl"
#include "adit/shaders/include/wide.glsl"
#include "adit/shaders/shared/preprocess.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;
layout(constant_id = 1) const uint kRun = 32;  // at most 32: see RunHead

layout(set = 0, binding = 0, scalar) readonly buffer Raw {
  uvec4 points[];
};  // bits of x, y, z, intensity
layout(set = 0, binding = 1, scalar) buffer Table { InputCell cells[]; };
layout(set = 0, binding = 2, scalar) writeonly buffer RunCounts { uint run_counts[]; };
layout(set = 0, binding = 3, scalar) writeonly buffer RunHeads { uint run_heads[]; };
layout(set = 0, binding = 4, scalar) buffer Counters { SweepCounters counters; };
layout(set = 0, binding = 5) uniform utextureBuffer points_texels;
layout(push_constant, scalar) uniform Push { DownsamplePush push; };

const uint kNoSlot = 0xffffffffu;

struct Run {
  uint first;  // raw index
  uint count;
  ivec3 cell;
  uvec3 sum;
};

vec3 position(uint i) { return uintBitsToFloat(FETCH(points, i).xyz); }

ivec3 cell_of(uint i) { return ivec3(floor(position(i) * push.inverse_cell)); }

#ifdef ADIT_WIDE
void add(uint slot, Run run) {
  atomicAdd(cells[slot].count_sum_x, (uint64_t(run.count) << kWideSumBits) | uint64_t(run.sum.x));
  atomicAdd(cells[slot].sum_y, uint64_t(run.sum.y));
  atomicAdd(cells[slot].sum_z, uint64_t(run.sum.z));
}
#else
void add(uint slot, Run run) {
  atomicAdd(cells[slot].count, run.count);
  const uvec3 before =
      uvec3(atomicAdd(cells[slot].sum_x, run.sum.x), atomicAdd(cells[slot].sum_y, run.sum.y),
            atomicAdd(cells[slot].sum_z, run.sum.z));
  const uvec3 carry = uvec3(lessThan(before + run.sum, before));
  const uint carries = carry.x | (carry.y << kCarryBits) | (carry.z << (2 * kCarryBits));
  if (carries != 0) {
    atomicAdd(cells[slot].carries, carries);
  }
}
#endif

// The slot of the cell that the run owns now, or kNoSlot. Threads mostly run in the order of the
// points, so that the first one to come is mostly the first point of its cell. Where it is not, the
// first point takes its place: another probe of the same slot.
uint insert(Run run) {
  const uint me = run.first + 1;
  uint slot = hash_cell(run.cell) & push.table_mask;
  uint expected = kFree;
  uint probes = 0;
  bool found = false;
  bool owns = false;
  while (!found && probes < kMaxProbes) {
    const uint owner = atomicCompSwap(cells[slot].owner, expected, me);
    const bool same = owner == kFree || cell_of(owner - 1) == run.cell;
    owns = owner == expected;
    found = owns || (same && owner < me);
    slot = same ? slot : (slot + 1) & push.table_mask;
    expected = same ? owner : kFree;
    probes += 1;
  }
  if (found) {
    add(slot, run);
  } else {
    atomicAdd(counters.input_failures, run.count);
  }
  return owns ? slot : kNoSlot;
}

void main() {
  const uint begin = gl_GlobalInvocationID.x * kRun;
  const uint end = min(begin + kRun, push.point_count);
  uint valid_points = 0;
  uint heads = 0;
  Run run = Run(0, 0, ivec3(0), uvec3(0));
  for (uint i = begin; i <= end && begin < end; ++i) {
    const vec3 p = position(min(i, end - 1));
    const float squared = dot(p, p);
    const bool valid =
        i < end && is_finite(p) && squared >= push.min_squared && squared <= push.max_squared;
    const vec3 scaled = p * push.inverse_cell;
    const vec3 corner = floor(scaled);
    const ivec3 cell = ivec3(corner);
    const bool continues = valid && run.count > 0 && cell == run.cell;
    if (!continues && run.count > 0) {
      const uint slot = insert(run);
      if (slot != kNoSlot) {
        run_heads[begin + heads] = pack_run_head(slot, run.first);
        heads += 1;
      }
      run.count = 0;
    }
    if (valid) {
      const uvec3 offset = fixed_offset(scaled, corner);
      run = Run(continues ? run.first : i, run.count + 1, cell,
                continues ? run.sum + offset : offset);
      valid_points += 1;
    }
  }
  if (begin < end) {
    run_counts[gl_GlobalInvocationID.x] = heads;
  }
  const uint valid_total = subgroupAdd(valid_points);
  if (subgroupElect()) {
    atomicAdd(counters.valid_points, valid_total);
  }
}
