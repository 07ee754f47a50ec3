// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Voxel down-sampling, pass 2 of 3: finds the runs that own their cells in the end. Each thread
// takes one part of the sweep's blocks. Written: its list of (slot of the cell, raw index), and how
// many it and its group found; from these pass 3 knows where to put its own: the output is in the
// order of the raw points, whatever the order of execution was.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#ifdef ADIT_WIDE
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#endif
#include "adit/shaders/include/hash.glsl"
#include "adit/shaders/include/parts.glsl"
#include "adit/shaders/include/wide.glsl"
#include "adit/shaders/shared/preprocess.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;
layout(constant_id = 1) const uint kRun = 32;

layout(set = 0, binding = 0, scalar) readonly buffer RunCounts { uint run_counts[]; };
layout(set = 0, binding = 1, scalar) readonly buffer RunHeads { uint run_heads[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Table { InputCell cells[]; };
layout(set = 0, binding = 3, scalar) writeonly buffer Firsts { PAIR firsts[]; };
layout(set = 0, binding = 4, scalar) writeonly buffer ThreadCounts { uint thread_counts[]; };
layout(set = 0, binding = 5, scalar) writeonly buffer GroupCounts { uint group_counts[]; };
layout(push_constant, scalar) uniform Push { CountPush push; };

shared uint group_count;

void main() {
  if (gl_LocalInvocationIndex == 0) {
    group_count = 0;
  }
  barrier();
  const Part part = part_of_thread((push.point_count + kRun - 1) / kRun, kLocalSize);
  uint count = 0;
  uint block = part.begin;
  uint left = block < part.end ? run_counts[block] : 0;
  uint place = block * kRun;
  while (block < part.end) {
    if (left > 0) {
      const RunHead run = unpack_run_head(run_heads[place], block * kRun);
      if (cells[run.slot].owner == run.first + 1) {
        firsts[part.begin * kRun + count] = PAIR_OF(uvec2(run.slot, run.first));
        count += 1;
      }
      place += 1;
      left -= 1;
    } else {
      block += 1;
      left = block < part.end ? run_counts[block] : 0;
      place = block * kRun;
    }
  }
  thread_counts[part.index] = count;
  const uint sum = subgroupAdd(count);
  if (subgroupElect()) {
    atomicAdd(group_count, sum);
  }
  barrier();
  if (gl_LocalInvocationIndex == 0) {
    group_counts[part.group] = group_count;
  }
}
