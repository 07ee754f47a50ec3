// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// One Gauss-Newton iteration of voxelised GICP (Koide et al., ICRA 2021; weight 1 a match), in one
// dispatch. One thread adds up its strided points in registers, a group reduces them to one row of
// partial sums, and the group that finishes last adds the rows in their order, solves for the step
// and says whether there is another iteration: it writes the pose, the system, and the size of the
// next indirect dispatch (zero when done). Nothing waits on another group, so no forward progress
// is assumed.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "shaders/include/lie.glsl"
#include "shaders/include/surface.glsl"
#include "shaders/include/sym3.glsl"
#include "shaders/include/texels.glsl"
#include "shaders/shared/preprocess.h"
#include "shaders/shared/registration.h"

layout(local_size_x_id = 0) in;
layout(constant_id = 0) const uint kLocalSize = 64;

layout(set = 0, binding = 0, scalar) readonly buffer Cloud { uvec4 surface_cloud[]; };
layout(set = 0, binding = 1, scalar) readonly buffer Counters { SweepCounters counters; };
layout(set = 0, binding = 2, scalar) readonly buffer Voxels {
  uvec4 voxels[];
};  // GaussianCell: 3 each
layout(set = 0, binding = 3, scalar) coherent buffer Partials { float partials[]; };
layout(set = 0, binding = 4, scalar) coherent buffer State { RegistrationState state; };
layout(set = 0, binding = 5) uniform utextureBuffer surface_cloud_texels;
layout(set = 0, binding = 6) uniform utextureBuffer voxels_texels;
layout(push_constant, scalar) uniform Push { LinearizePush push; };

const uint kMaxSubgroups = kLocalSize / 4;  // no baseline device has subgroups of fewer than 4
shared float subgroup_sums[kMaxSubgroups * kSystemSize];
shared float system[kSystemStride];
shared bool is_last;

struct Match {
  bool found;
  vec3 error;       // mean - transformed point, map axes, m
  Sym3 constraint;  // mean of P over the voxel's points
};

Match match(vec3 q) {
  const vec3 corner = floor(q * push.inverse_cell);
  const uint key = pack_voxel(ivec3(corner));
  uint slot = mix32(key) & push.table_mask;
  uint probes = 0;
  uvec4 head = FETCH(voxels, 3 * slot);
  while (head.x != key && head.x != kFree && probes < kMaxProbes) {
    slot = (slot + 1) & push.table_mask;
    head = FETCH(voxels, 3 * slot);
    probes += 1;
  }
  const uvec4 middle = FETCH(voxels, 3 * slot + 1);
  const uvec4 tail = FETCH(voxels, 3 * slot + 2);
  Match m;
  m.found = head.x == key && key != kFree && head.y > 0;
  const float per_point = m.found ? 1.0 / float(head.y) : 0.0;
  const vec3 mean = vec3(head.zw, middle.x) * (per_point / 65536.0);
  m.error = (corner + mean) * push.cell - q;
  m.found = m.found && dot(m.error, m.error) <= push.max_squared;
  const float scale = per_point / 32768.0;
  m.constraint = Sym3(float(middle.y) * scale - 1.0, float(middle.z) * scale - 1.0,
                      float(middle.w) * scale - 1.0, float(tail.x) * scale - 1.0,
                      float(tail.y) * scale - 1.0, float(tail.z) * scale - 1.0);
  return m;
}

// Inverse of the sum of the voxel's and the rotated point's regularised covariances.
Sym3 information(Sym3 target, vec3 v, vec2 w) {
  const float k = 1.0 - push.epsilon;
  const vec3 bv = w.y * v;
  return inverse(Sym3(2.0 - k * (target.xx + w.x + bv.x * v.x), -k * (target.xy + bv.x * v.y),
                      -k * (target.xz + bv.x * v.z), 2.0 - k * (target.yy + w.x + bv.y * v.y),
                      -k * (target.yz + bv.y * v.z), 2.0 - k * (target.zz + w.x + bv.z * v.z)));
}

// Adds a match: e = mean - (R a + t), de/drho = -I, de/dphi = [R a]x with ra = R a.
void accumulate(inout float sums[kSystemSize], vec3 ra, vec3 e, Sym3 omega, Sym3 constraint,
                float weight) {
  const vec3 ox = weight * vec3(omega.xx, omega.xy, omega.xz);
  const vec3 oy = weight * vec3(omega.xy, omega.yy, omega.yz);
  const vec3 oz = weight * vec3(omega.xz, omega.yz, omega.zz);
  const vec3 oe = vec3(dot(ox, e), dot(oy, e), dot(oz, e));
  // Omega [ra]x, rows; H_tr = -Omega [ra]x, H_rr = -[ra]x Omega [ra]x.
  const vec3 ax = cross(ox, ra);
  const vec3 ay = cross(oy, ra);
  const vec3 az = cross(oz, ra);
  const vec3 rr_y = vec3(0.0, ra.z * ax.y - ra.x * az.y, ra.z * ax.z - ra.x * az.z);
  sums[0] += ox.x;
  sums[1] += ox.y;
  sums[2] += ox.z;
  sums[3] -= ax.x;
  sums[4] -= ax.y;
  sums[5] -= ax.z;
  sums[6] += oy.y;
  sums[7] += oy.z;
  sums[8] -= ay.x;
  sums[9] -= ay.y;
  sums[10] -= ay.z;
  sums[11] += oz.z;
  sums[12] -= az.x;
  sums[13] -= az.y;
  sums[14] -= az.z;
  sums[15] -= ra.y * az.x - ra.z * ay.x;
  sums[16] -= ra.y * az.y - ra.z * ay.y;
  sums[17] -= ra.y * az.z - ra.z * ay.z;
  sums[18] -= rr_y.y;
  sums[19] -= rr_y.z;
  sums[20] -= ra.x * ay.z - ra.y * ax.z;
  sums[21] -= oe.x;
  sums[22] -= oe.y;
  sums[23] -= oe.z;
  const vec3 gr = cross(ra, oe);
  sums[24] -= gr.x;
  sums[25] -= gr.y;
  sums[26] -= gr.z;
  sums[27] += dot(e, oe);
  sums[28] += weight * dot(e, mul(constraint, e));
  sums[29] += weight;
}

// Matches that change from step to step can make Gauss-Newton go to and fro between two poses for
// ever. A step that goes back, and at least half as far as the last one went, is halved, and so are
// all that follow.
void damp(inout float step[6]) {
  float back = 0.0;
  float before = 0.0;
  float now = 0.0;
  for (uint i = 0; i < 6; ++i) {
    const float last = state.last_step[i];
    back -= last * step[i];
    before += last * last;
    now += step[i] * step[i];
  }
  const float damping = back > 0.0 && now > 0.25 * before ? 0.5 * state.damping : state.damping;
  for (uint i = 0; i < 6; ++i) {
    step[i] *= damping;
    state.last_step[i] = step[i];
  }
  state.damping = damping;
}

// Cholesky of the system scaled to a unit diagonal, since metres and radians differ by the cloud's
// extent.
bool solve(out float step[6]) {
  float h[36];
  uint k = 0;
  for (uint i = 0; i < 6; ++i) {
    for (uint j = i; j < 6; ++j) {
      h[6 * j + i] = system[k];
      ++k;
    }
  }
  float scale[6];
  bool ok = true;
  for (uint i = 0; i < 6; ++i) {
    ok = ok && h[7 * i] > 0.0;
    scale[i] = inversesqrt(max(h[7 * i], 1e-30));
  }
  for (uint j = 0; j < 6; ++j) {
    for (uint i = j; i < 6; ++i) {
      float sum = h[6 * i + j] * scale[i] * scale[j] + (i == j ? 1e-6 : 0.0);
      for (uint l = 0; l < j; ++l) {
        sum -= h[6 * i + l] * h[6 * j + l];
      }
      if (i == j) {
        ok = ok && sum > 0.0;
        h[7 * j] = sqrt(max(sum, 1e-30));
      } else {
        h[6 * i + j] = sum / h[7 * j];
      }
    }
  }
  for (uint i = 0; i < 6; ++i) {
    float sum = -system[21 + i] * scale[i];
    for (uint l = 0; l < i; ++l) {
      sum -= h[6 * i + l] * step[l];
    }
    step[i] = sum / h[7 * i];
  }
  for (uint n = 0; n < 6; ++n) {
    const uint i = 5 - n;
    float sum = step[i];
    for (uint l = i + 1; l < 6; ++l) {
      sum -= h[6 * l + i] * step[l];
    }
    step[i] = sum / h[7 * i];
  }
  damp(step);
  for (uint i = 0; i < 6; ++i) {
    step[i] *= scale[i];
  }
  return ok;
}

void stop(uint failed) {
  state.failed = failed;
  state.phase = kPhaseDone;
  state.groups_x = 0;
}

void take_step() {
  float step[6];
  const bool solved = solve(step);
  const vec3 rho = vec3(step[0], step[1], step[2]);
  const vec3 phi = vec3(step[3], step[4], step[5]);
  if (!solved || !is_finite(rho) || !is_finite(phi) || system[29] < 6.0) {
    stop(1);
    return;
  }
  const mat3x4 pose = state.pose;
  const mat3 rotation =
      orthonormal_rows(mat3(pose[0].xyz, pose[1].xyz, pose[2].xyz) * so3_exp_rows(phi));
  const vec3 t = vec3(pose[0].w, pose[1].w, pose[2].w) + rho;
  state.pose = mat3x4(vec4(rotation[0], t.x), vec4(rotation[1], t.y), vec4(rotation[2], t.z));
  state.iterations += 1;
  const bool converged =
      length(rho) < push.translation_epsilon && length(phi) < push.rotation_epsilon;
  state.converged = converged ? 1 : 0;
  if (converged || state.iterations >= push.max_iterations) {
    state.phase = kPhaseEvaluate;
  }
}

void main() {
  const uint local = gl_LocalInvocationIndex;
  const uint threads = gl_NumWorkGroups.x * kLocalSize;
  const uint count = counters.cloud_points;
  const mat3x4 pose = state.pose;

  float sums[kSystemSize];
  for (uint k = 0; k < kSystemSize; ++k) {
    sums[k] = 0.0;
  }
  for (uint i = gl_GlobalInvocationID.x; i < count; i += threads) {
    const uvec4 point = FETCH(surface_cloud, i);
    const vec3 ra = vec4(uintBitsToFloat(point.xyz), 0.0) * pose;
    const vec3 v = vec4(unpack_direction(point.w), 0.0) * pose;
    const Match m = match(ra + vec3(pose[0].w, pose[1].w, pose[2].w));
    const Sym3 omega = information(m.constraint, v, surface_weights(point.w));
    if (m.found) {
      accumulate(sums, ra, m.error, omega, m.constraint, 1.0);
    }
  }

  for (uint k = 0; k < kSystemSize; ++k) {
    const float sum = subgroupAdd(sums[k]);
    if (subgroupElect()) {
      subgroup_sums[gl_SubgroupID * kSystemSize + k] = sum;
    }
  }
  barrier();
  if (local < kSystemSize) {
    float sum = 0.0;
    for (uint s = 0; s < gl_NumSubgroups; ++s) {
      sum += subgroup_sums[s * kSystemSize + local];
    }
    partials[gl_WorkGroupID.x * kSystemStride + local] = sum;
    memoryBarrierBuffer();
  }
  barrier();
  if (local == 0) {
    is_last = atomicAdd(state.ticket, 1) == gl_NumWorkGroups.x - 1;
  }
  barrier();
  if (!is_last) {
    return;
  }
  memoryBarrierBuffer();
  if (local < kSystemSize) {
    float sum = 0.0;
    for (uint g = 0; g < gl_NumWorkGroups.x; ++g) {
      sum += partials[g * kSystemStride + local];
    }
    system[local] = sum;
    state.system[local] = sum;
  }
  barrier();
  if (local == 0) {
    state.ticket = 0;
    if (state.phase == kPhaseEvaluate) {
      stop(0);
    } else {
      take_step();
    }
  }
}
