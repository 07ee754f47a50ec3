// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Holds a plan, turned by an angle, against that of a place at every shift of a few cells. One
// thread takes shifts strided over the group, one group a job. Written: for each job the shift with
// the most cells on the place's (once more for those that are exactly on one), and how many.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "adit/shaders/shared/places.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) readonly buffer Cells { vec2 cells[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Jobs { PlanJob jobs[]; };
layout(set = 0, binding = 2, scalar) readonly buffer Block { uint block[]; };
layout(set = 0, binding = 3, scalar) writeonly buffer Matches { uint matches[]; };
layout(push_constant, scalar) uniform Push { CorrelatePush push; };

shared uint plan[kPlanWords];
shared uint spread[kPlanWords];
shared uint best;

// The row's word with its bits spread to both sides.
uint spread_along(uint i) {
  const uint column = i % kPlanRow;
  const uint before = column > 0u ? plan[i - 1u] >> 31 : 0u;
  const uint after = column + 1u < kPlanRow ? plan[i + 1u] << 31 : 0u;
  return plan[i] | (plan[i] << 1) | (plan[i] >> 1) | before | after;
}

void main() {
  const uint thread = gl_LocalInvocationID.x;
  const PlanJob job = jobs[push.first_job + gl_WorkGroupID.x];
  for (uint i = thread; i < kPlanWords; i += kLocalSize) {
    plan[i] = block[kBlockPlansAt + kPlanWords * job.place + i];
  }
  if (thread == 0u) {
    best = 0u;
  }
  barrier();
  for (uint i = thread; i < kPlanWords; i += kLocalSize) {
    const uint below = i >= kPlanRow ? spread_along(i - kPlanRow) : 0u;
    const uint above = i + kPlanRow < kPlanWords ? spread_along(i + kPlanRow) : 0u;
    spread[i] = below | spread_along(i) | above;
  }
  barrier();
  for (uint shift = thread; shift < kShifts; shift += kLocalSize) {
    const vec2 moved =
        vec2(shift % kShiftSide, shift / kShiftSide) + (float(kPlanSide / 2) - float(kShiftReach));
    uint hits = 0;
    for (uint i = 0; i < push.cell_count; ++i) {
      const vec2 c = cells[i];
      const vec2 p =
          floor(vec2(job.cosine * c.x - job.sine * c.y, job.sine * c.x + job.cosine * c.y) + moved);
      const bool inside = all(greaterThanEqual(p, vec2(0.0))) && all(lessThan(p, vec2(kPlanSide)));
      const uvec2 at = uvec2(clamp(p, vec2(0.0), vec2(kPlanSide - 1u)));
      const uint word = kPlanRow * at.y + (at.x >> 5);
      const uint bits = ((plan[word] >> (at.x & 31u)) & 1u) + ((spread[word] >> (at.x & 31u)) & 1u);
      hits += inside ? bits : 0u;
    }
    atomicMax(best, (hits << kShiftBits) | shift);
  }
  barrier();
  if (thread == 0u) {
    matches[push.first_job + gl_WorkGroupID.x] = best;
  }
}
