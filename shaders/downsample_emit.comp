// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Voxel down-sampling, pass 3 of 3: writes one point a cell (its centroid; intensity of the cell's
// first point, and its place where the sums may have overflowed), in the order of the raw points,
// and frees the cell for the next sweep. The same parts and threads as in pass 2. Each new point is
// also added to the surface cell that surface_normals.comp will ask.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/include/parts.glsl"
#include "adit/shaders/include/texels.glsl"
#include "adit/shaders/shared/gaussian_cell.h"
#include "adit/shaders/shared/preprocess.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;
layout(constant_id = 1) const uint kRun = 8;

layout(set = 0, binding = 0, scalar) readonly buffer Raw { uvec4 points[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Firsts { uvec2 firsts[]; };
layout(set = 0, binding = 2, scalar) buffer Table { InputCell cells[]; };
layout(set = 0, binding = 3, scalar) readonly buffer ThreadCounts { uint thread_counts[]; };
layout(set = 0, binding = 4, scalar) readonly buffer GroupCounts { uint group_counts[]; };
layout(set = 0, binding = 5, scalar) writeonly buffer Cloud { vec4 cloud[]; };
layout(set = 0, binding = 6, scalar) buffer Surfaces { GaussianCell surfaces[]; };
layout(set = 0, binding = 7, scalar) buffer Counters { SweepCounters counters; };
layout(set = 0, binding = 8) uniform utextureBuffer points_texels;
layout(push_constant, scalar) uniform Push { EmitPush push; };

#include "adit/shaders/include/surface_sums.glsl"

shared uint counts[kLocalSize];  // of this group's threads
shared uint group_offset;

// Points before this thread's: those of earlier groups, and of earlier threads of this group.
uint output_offset(Part part, uint count) {
  const uint local = gl_LocalInvocationIndex;
  counts[local] = count;
  if (local == 0) {
    group_offset = 0;
  }
  barrier();
  uint before = 0;
  for (uint g = local; g < part.group; g += kLocalSize) {
    before += group_counts[g];
  }
  atomicAdd(group_offset, before);
  barrier();
  uint offset = group_offset;
  for (uint t = 0; t < local; ++t) {
    offset += counts[t];
  }
  if (part.group == gl_NumWorkGroups.x - 1 && local == kLocalSize - 1) {
    counters.cloud_points = offset + count;
  }
  return offset;
}

void main() {
  const Part part = part_of_thread((push.point_count + kRun - 1) / kRun, kLocalSize);
  const uint count = thread_counts[part.index];
  const uint offset = output_offset(part, count);
  for (uint k = 0; k < count; ++k) {
    const uvec2 first = firsts[part.begin * kRun + k];
    const vec4 raw = uintBitsToFloat(FETCH(points, first.y));
    const InputCell cell = cells[first.x];
    cells[first.x] = InputCell(kFree, 0, 0, 0, 0, 0);
    const vec3 mean =
        (vec3(cell.sum_x, cell.sum_y, cell.sum_z) / float(cell.count) + 0.5) / 65536.0;
    vec3 p = (floor(raw.xyz * push.inverse_cell) + mean) * push.cell;
    if (cell.count > kMostCellPoints) {
      p = raw.xyz;
      atomicAdd(counters.crowded_cells, 1);
    }
    cloud[offset + k] = vec4(p, raw.w);
    const uint level = surface_level(p, push.level_factor);
    for (uint wider = 0; wider < 2; ++wider) {
      if (!add_to_surface(surface_cell_of_level(p, level + wider, push.inverse_surface_cell),
                          push.surface_mask)) {
        atomicAdd(counters.surface_failures, 1);
      }
    }
  }
}
