// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// From the sums of an alignment to its next pose: one thread of the group that finished last.
#ifndef ADIT_REGISTRATION_STEP_GLSL
#define ADIT_REGISTRATION_STEP_GLSL
#include "adit/shaders/include/lie.glsl"
#include "adit/shaders/include/registration_match.glsl"

shared float system[kSystemStride];

// How much of a Gauss-Newton step to take. Steps that go on the same way and shrink by r each would
// add up to 1 / (1 - r) of the first: with the factor f of the last step, f / (1 - r) is the
// secant's estimate of the whole way. But matches change from step to step, which can make
// Gauss-Newton go to and fro between two poses for ever: a step that goes back, and at least half
// as far as the last one went, is halved, and no later one is longer.
void scale_step(uint job, inout float step[6]) {
  float along = 0.0;
  float before = 0.0;
  float now = 0.0;
  for (uint i = 0; i < 6; ++i) {
    const float last = progress[job].last_step[i];
    along += last * step[i];
    before += last * last;
    now += step[i] * step[i];
    progress[job].last_step[i] = step[i];
  }
  const float last_factor = progress[job].factor;
  const float shrinking = along / max(before, 1e-30);
  if (along < 0.0 && now > 0.25 * last_factor * last_factor * before) {
    progress[job].most_factor = 0.5 * min(last_factor, 1.0);
  }
  const bool same_way = along > 0.0 && along * along > 0.64 * now * before;
  const float wanted = same_way ? last_factor / max(1.0 - shrinking, 1e-3) : 1.0;
  const float factor = min(max(wanted, 1.0), progress[job].most_factor);
  progress[job].factor = factor;
  for (uint i = 0; i < 6; ++i) {
    step[i] *= factor;
  }
}

// Cholesky of the system (its lower triangle) scaled to a unit diagonal, since metres and radians
// differ by the cloud's extent.
bool solve(uint job, float h[36], float gradient[6], out float step[6]) {
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
    float sum = -gradient[i] * scale[i];
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
  scale_step(job, step);
  for (uint i = 0; i < 6; ++i) {
    step[i] *= scale[i];
  }
  return ok;
}

// H and g of the sums, full and without weak directions.
void unpack_system(out float h[36], out float gradient[6]) {
  uint k = 0;
  for (uint i = 0; i < 6; ++i) {
    for (uint j = i; j < 6; ++j) {
      h[6 * i + j] = system[k];
      h[6 * j + i] = system[k];
      ++k;
    }
    gradient[i] = system[21 + i];
  }
}

// Takes the step; says whether there is another one to take.
bool take_step(uint job, float h[36], float gradient[6]) {
  float step[6];
  const bool solved = solve(job, h, gradient, step);
  const vec3 rho = vec3(step[0], step[1], step[2]);
  const vec3 phi = vec3(step[3], step[4], step[5]);
  if (!solved || !is_finite(rho) || !is_finite(phi) || system[kInliersAt] < 6.0) {
    progress[job].failed = 1;
    return false;
  }
  const mat3x4 pose = states[job].pose;
  const mat3 rotation =
      orthonormal_rows(mat3(pose[0].xyz, pose[1].xyz, pose[2].xyz) * so3_exp_rows(phi));
  const vec3 t = vec3(pose[0].w, pose[1].w, pose[2].w) + rho;
  states[job].pose = mat3x4(vec4(rotation[0], t.x), vec4(rotation[1], t.y), vec4(rotation[2], t.z));
  progress[job].iterations += 1;
  const bool converged =
      length(rho) < push.translation_epsilon && length(phi) < push.rotation_epsilon;
  progress[job].converged = converged ? 1 : 0;
  return !converged && progress[job].iterations < push.max_iterations;
}

#endif
