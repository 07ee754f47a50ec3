// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Voxel down-sampling, pass 3 of 3: writes one point a cell (its centroid; intensity of the cell's first
// point), in the order of the raw points, and frees the cell for the next sweep. The same parts and threads
// as in pass 2. Each new point is also added to the surface cell that surface_normals.comp will ask.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/include/surface.glsl"
#include "shaders/shared/gaussian_cell.h"
#include "shaders/shared/preprocess.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) readonly buffer Raw { vec4 points[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Slots { uint slot_of[]; };
layout(set = 0, binding = 2, scalar) buffer Table { InputCell cells[]; };
layout(set = 0, binding = 3, scalar) readonly buffer ThreadCounts { uint thread_counts[]; };
layout(set = 0, binding = 4, scalar) readonly buffer GroupCounts { uint group_counts[]; };
layout(set = 0, binding = 5, scalar) writeonly buffer Cloud { vec4 cloud[]; };
layout(set = 0, binding = 6, scalar) buffer Surfaces { GaussianCell surfaces[]; };
layout(set = 0, binding = 7, scalar) buffer Counters { SweepCounters counters; };
layout(push_constant, scalar) uniform Push { EmitPush push; };

shared uint thread_offsets[kLocalSize];

void add_to_surface(vec3 p) {
  const SurfaceCellId id = surface_cell(p, push.inverse_surface_cell, push.level_factor);
  uint slot = mix32(id.key) & push.surface_mask;
  uint probes = 0;
  bool found = false;
  while (!found && probes < kMaxProbes) {
    const uint key = atomicCompSwap(surfaces[slot].key, kFree, id.key);
    found = key == kFree || key == id.key;
    slot = found ? slot : (slot + 1) & push.surface_mask;
    probes += 1;
  }
  if (!found) {
    return;  // surface_normals.comp counts it
  }
  const uvec3 o = id.offset;
  const uvec3 x = (o * o.x + 32768) >> 16;  // xx, xy, xz
  const uvec3 y = (o * o.y + 32768) >> 16;  // xy, yy, yz
  atomicAdd(surfaces[slot].count, 1);
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

// Points before this thread's: those of earlier groups, and of earlier threads of this group.
uint output_offset() {
  const uint local = gl_LocalInvocationIndex;
  thread_offsets[local] = thread_counts[gl_GlobalInvocationID.x];
  barrier();
  if (local == 0) {
    uint offset = 0;
    for (uint g = 0; g < gl_WorkGroupID.x; ++g) {
      offset += group_counts[g];
    }
    for (uint t = 0; t < kLocalSize; ++t) {
      const uint count = thread_offsets[t];
      thread_offsets[t] = offset;
      offset += count;
    }
    if (gl_WorkGroupID.x == gl_NumWorkGroups.x - 1) {
      counters.cloud_points = offset;
    }
  }
  barrier();
  return thread_offsets[local];
}

void main() {
  const uint part = (push.point_count + gl_NumWorkGroups.x * kLocalSize - 1) / (gl_NumWorkGroups.x * kLocalSize);
  const uint begin = gl_GlobalInvocationID.x * part;
  const uint end = min(begin + part, push.point_count);
  const uint count = thread_counts[gl_GlobalInvocationID.x];
  uint offset = output_offset();
  const uint last = offset + count;
  uint i = begin;
  while (offset < last) {
    // Find this thread's next first point: a light loop, so that the heavy body below runs once a cell.
    uint slot = kFree;
    bool first = false;
    while (!first && i < end) {
      slot = slot_of[i];
      if (slot != kFree) {
        first = cells[slot - 1].inverted_first == ~i;
      }
      ++i;
    }
    const vec4 raw = points[i - 1];
    const InputCell cell = cells[slot - 1];
    cells[slot - 1] = InputCell(kFree, 0, 0, 0, 0, 0, 0, 0);
    const vec3 mean = (vec3(cell.sum_x, cell.sum_y, cell.sum_z) / float(cell.count) + 0.5) / 65536.0;
    const vec3 p = (floor(raw.xyz * push.inverse_cell) + mean) * push.cell;
    cloud[offset] = vec4(p, raw.w);
    add_to_surface(p);
    ++offset;
  }
}
