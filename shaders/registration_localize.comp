// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Which directions of each aligned pose its matches really hold: for the eigenvectors of the
// information, the matches whose two normals agree and both have a share in the direction (after
// X-ICP, Tuna et al., T-RO 2023, with the target's normal beside the source's:
// docs/theory/registration.md). Noise of normals holds nothing, however many they are. Decides the
// class of each direction, and sends alignments with weak ones into constrained steps.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "adit/shaders/include/registration_match.glsl"

const uint kSupports = 7;  // for the six directions, and the matches
const uint kRowSize = kSupports;
#include "adit/shaders/include/registration_rows.glsl"
const uint kMaxSubgroups = kLocalSize / 4;
shared float subgroup_sums[kMaxSubgroups * kSupports];
shared bool is_last;

const float kAgree = 0.94;   // cos 20 degrees, between the two normals
const float kShare = 0.174;  // cos 80 degrees: a normal has a share in a direction
const float kPlanar = 0.9;   // largest eigenvalue of the voxel's mean normal outer product
// A direction is not held at all by less than this, or this part of the matches: what wrong normals
// can make up in a smooth tunnel, or rings on grass.
const float kNone = 13.0;
const float kNoneOf = 1e-3;
// And it is held in full by this, but small clouds need no more than a part of their matches, and
// large ones no less than another.
const float kFull = 100.0;
const float kFullOfSmall = 0.02;
const float kFullOfLarge = 0.005;

// The normal of a planar voxel; zero for any other.
vec3 normal_of(Voxel voxel) {
  if (kMethod == kVgicp || kMethod == kPointToPlane) {
    const float trace = voxel.form.xx + voxel.form.yy + voxel.form.zz;
    const float value = eigenvalues(voxel.form).z;
    return value > kPlanar * max(trace, 1.0) ? eigenvector(voxel.form, value) : vec3(0.0);
  }
  const Sym3 unit = scaled(voxel.form, 1.0 / (voxel.form.xx + voxel.form.yy + voxel.form.zz));
  const vec3 values = eigenvalues(unit);
  return values.x < 0.1 * values.y ? eigenvector(unit, values.x) : vec3(0.0);
}

vec3 at_most_unit(vec3 v) { return v * inversesqrt(max(dot(v, v), 1.0)); }

void decide(uint at, float sums[kSupports]) {
  const float none = max(kNone, kNoneOf * sums[6]);
  const float full = max(min(kFull, kFullOfSmall * sums[6]), kFullOfLarge * sums[6]);
  bool weak = false;
  for (uint k = 0; k < 6; ++k) {
    const float share = sums[k] <= none ? 0.0 : min(sums[k] / full, 1.0);
    states[at].support[k].x = sums[k];
    states[at].share[k] = share;
    weak = weak || share < push.weak_share || share == 0.0;
  }
  progress[at].phase = kPhaseDone;
  if (weak && push.serves == kPhaseLocalize && push.max_iterations > 0) {
    states[at].constrained = kWithoutWeak;
    progress[at].phase = kPhaseConstrained;
    progress[at].iterations = 0;
    progress[at].converged = 0;
    progress[at].factor = 1.0;
    progress[at].most_factor = kLongest;
    for (uint i = 0; i < 6; ++i) {
      progress[at].last_step[i] = 0.0;
    }
    atomicAdd(header.constrained.remaining, 1);
    header.constrained.groups_x = push.group_stride;
    header.reassess.groups_x = push.group_stride;
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
  const vec3 t = vec3(pose[0].w, pose[1].w, pose[2].w);

  // Software devices read a word once a lane, for every point; GPUs read it from their caches, and
  // need the registers.
  vec3 directions[6];
  for (uint k = 0; k < 6; ++k) {
    directions[k] = kTexels ? states[at].directions[k].xyz : vec3(0.0);
  }
  float sums[kSupports];
  for (uint k = 0; k < kSupports; ++k) {
    sums[k] = 0.0;
  }
  const uint threads = groups * kLocalSize;
  for (uint i = gl_WorkGroupID.x * kLocalSize + local; i < job.source_count; i += threads) {
    const SourcePoint s = source_point(job.source_begin + i, pose);
    const vec3 q = s.ra + t;
    const Voxel voxel =
        find_voxel(floor(q * job.inverse_cell), job.target_begin, job.table_mask, job.cell);
    const vec3 e = voxel.mean - q;
    const bool matched = voxel.found && dot(e, e) <= job.max_squared && !is_other_face(s, voxel);
    const vec3 target_normal = normal_of(voxel);
    if (matched) {
      sums[6] += 1.0;
    }
    if (matched && s.plane && abs(dot(s.direction, target_normal)) > kAgree) {
      const vec3 ms = at_most_unit(cross(s.ra, s.direction));
      const vec3 mt = at_most_unit(cross(s.ra, target_normal));
      for (uint k = 0; k < 6; ++k) {
        const vec3 v = kTexels ? directions[k] : states[at].directions[k].xyz;
        const float share = k < 3 ? min(abs(dot(s.direction, v)), abs(dot(target_normal, v)))
                                  : min(abs(dot(ms, v)), abs(dot(mt, v)));
        sums[k] += share > kShare ? share : 0.0;
      }
    }
  }

  for (uint k = 0; k < kSupports; ++k) {
    const float sum = subgroupAdd(sums[k]);
    if (subgroupElect()) {
      subgroup_sums[gl_SubgroupID * kSupports + k] = sum;
    }
  }
  barrier();
  if (local < kSupports) {
    float sum = 0.0;
    for (uint s = 0; s < gl_NumSubgroups; ++s) {
      sum += subgroup_sums[s * kSupports + local];
    }
    partials[(at * push.group_stride + gl_WorkGroupID.x) * kSystemStride + local] = sum;
    memoryBarrierBuffer();
  }
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
  if (local < kSupports) {
    row_parts[local] = row_sum(local);  // which no other thread reads
  }
  barrier();
  if (local != 0) {
    return;
  }
  for (uint k = 0; k < kSupports; ++k) {
    sums[k] = row_parts[k];
  }
  progress[at].ticket = 0;
  decide(at, sums);
}
