// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// One Gauss-Newton iteration of every alignment of a batch, in one dispatch: gl_WorkGroupID.y is
// the alignment, gl_WorkGroupID.x a group of those that share its source. One thread adds up its
// strided points in registers, a group reduces them to one row of partial sums, and the group that
// finishes an alignment last adds the rows in their order, solves for the step and says what the
// alignment waits for next; the alignment that ends last zeroes the next indirect dispatch. Nothing
// waits on another group, so no forward progress is assumed.
//
// With kGeometry the same sums and those of registration_directions.glsl: the assessment of a final
// pose, and the steps of alignments with weak directions.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "adit/shaders/include/registration_directions.glsl"
#include "adit/shaders/include/registration_sums.glsl"

const uint kRowSize = kSums;
#include "adit/shaders/include/registration_rows.glsl"

const uint kMaxSubgroups = kLocalSize / 4;  // no baseline device has subgroups of fewer than 4
shared float subgroup_sums[kMaxSubgroups * kSums];
shared bool is_last;

// The group that finished last: what comes next for its alignment.
void go_on(uint job) {
  const uint phase = push.serves;
  if (kGeometry && (phase == kPhaseAssess || phase == kPhaseReassess)) {
    write_directions(job);
    progress[job].phase = phase + 1;
    return;
  }
  float h[36];
  float gradient[6];
  unpack_system(h, gradient);
  if (kGeometry) {
    constrain(job, h, gradient);
  }
  if (take_step(job, h, gradient)) {
    return;
  }
  progress[job].phase = progress[job].failed != 0 ? kPhaseDone : phase + 1;
  if (phase == kPhaseIterate) {
    if (atomicAdd(header.iterate.remaining, 0xffffffffu) == 1) {
      header.iterate.groups_x = 0;
    }
  } else if (atomicAdd(header.constrained.remaining, 0xffffffffu) == 1) {
    header.constrained.groups_x = 0;
  }
}

void main() {
  const uint local = gl_LocalInvocationIndex;
  const uint at = gl_WorkGroupID.y;
  const RegistrationJob job = jobs[at];
  const uint groups = groups_of(job);
  if (progress[at].phase != push.serves || gl_WorkGroupID.x >= groups) {
    return;
  }
  const mat3x4 pose = states[at].pose;
  const float max_squared =
      progress[at].iterations < job.wide_iterations ? job.wide_squared : job.max_squared;

  float sums[kSums];
  for (uint k = 0; k < kSums; ++k) {
    sums[k] = 0.0;
  }
  const uint threads = groups * kLocalSize;
  for (uint i = gl_WorkGroupID.x * kLocalSize + local; i < job.source_count; i += threads) {
    const SourcePoint s = source_point(job.source_begin + (kMethod == kNdtToNdt ? 3 * i : i), pose);
    accumulate(sums, s.ra, pull_of(s, pose, job, max_squared));
  }

  for (uint k = 0; k < kSums; ++k) {
    const float sum = subgroupAdd(sums[k]);
    if (subgroupElect()) {
      subgroup_sums[gl_SubgroupID * kSums + k] = sum;
    }
  }
  barrier();
  const uint row = at * push.group_stride + gl_WorkGroupID.x;
  for (uint k = local; k < kSums; k += kLocalSize) {
    float sum = 0.0;
    for (uint s = 0; s < gl_NumSubgroups; ++s) {
      sum += subgroup_sums[s * kSums + k];
    }
    partials[row * kSystemStride + k] = sum;
  }
  memoryBarrierBuffer();
  barrier();
  if (local == 0) {
    is_last = atomicAdd(progress[at].ticket, 1) == groups - 1;
  }
  barrier();
  if (!is_last) {
    return;
  }
  memoryBarrierBuffer();
  add_row_parts(at, groups);
  barrier();
  for (uint k = local; k < kSums; k += kLocalSize) {
    const float sum = row_sum(k);
    system[k] = sum;
    states[at].system[k] = sum;
  }
  barrier();
  if (local == 0) {
    progress[at].ticket = 0;
    go_on(at);
  }
}
