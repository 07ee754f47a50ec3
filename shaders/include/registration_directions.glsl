// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the sums of an alignment say of its directions, and how weak ones are taken out of a system
// (docs/theory/registration.md). One thread of the group that finished last.
#ifndef ADIT_REGISTRATION_DIRECTIONS_GLSL
#define ADIT_REGISTRATION_DIRECTIONS_GLSL
#include "adit/shaders/include/jacobi.glsl"
#include "adit/shaders/include/registration_step.glsl"

// The information that every match would have by itself if it held its point in all directions
// alike: sum of w J^T J.
void isotropic_information(out float g[36]) {
  const uint at = kGeometryAt;
  const vec3 s = vec3(system[at + 1], system[at + 2], system[at + 3]);
  const Sym3 m = Sym3(system[at + 4], system[at + 5], system[at + 6], system[at + 7],
                      system[at + 8], system[at + 9]);
  for (uint i = 0; i < 36; ++i) {
    g[i] = 0.0;
  }
  for (uint i = 0; i < 3; ++i) {
    g[7 * i] = system[at];
  }
  // -[s]x in the upper right, its transpose in the lower left; trace(m) I - m.
  g[6 * 0 + 4] = g[6 * 4 + 0] = s.z;
  g[6 * 0 + 5] = g[6 * 5 + 0] = -s.y;
  g[6 * 1 + 3] = g[6 * 3 + 1] = -s.z;
  g[6 * 1 + 5] = g[6 * 5 + 1] = s.x;
  g[6 * 2 + 3] = g[6 * 3 + 2] = s.y;
  g[6 * 2 + 4] = g[6 * 4 + 2] = -s.x;
  g[6 * 3 + 3] = m.yy + m.zz;
  g[6 * 4 + 4] = m.xx + m.zz;
  g[6 * 5 + 5] = m.xx + m.yy;
  g[6 * 3 + 4] = g[6 * 4 + 3] = -m.xy;
  g[6 * 3 + 5] = g[6 * 5 + 3] = -m.xz;
  g[6 * 4 + 5] = g[6 * 5 + 4] = -m.yz;
}

// The system without the information that regularised covariances claim in every direction, and
// likewise the gradient.
void take_out_fictitious(inout float h[36], inout float gradient[6]) {
  float g[36];
  isotropic_information(g);
  for (uint i = 0; i < 36; ++i) {
    h[i] -= push.fictitious * g[i];
  }
  for (uint i = 0; i < 6; ++i) {
    gradient[i] += push.fictitious * system[kGeometryAt + 10 + i];
  }
}

Sym3 block(float h[36], uint at) {
  return Sym3(h[7 * at], h[7 * at + 1], h[7 * at + 2], h[7 * at + 7], h[7 * at + 8],
              h[7 * at + 14]);
}

// Rows: translation, columns: rotation.
vec3 coupling_row(float h[36], uint row) {
  return vec3(h[6 * row + 3], h[6 * row + 4], h[6 * row + 5]);
}

vec3 coupling_column(float h[36], uint column) {
  return vec3(h[3 + column], h[9 + column], h[15 + column]);
}

Sym3 inverse_of_block(float h[36], uint at) {
  Sym3 b = block(h, at);
  const float ridge = 1e-6 * (b.xx + b.yy + b.zz) + 1e-20;
  b.xx += ridge;
  b.yy += ridge;
  b.zz += ridge;
  return inverse(b);
}

// Information on translation once rotation is free (at = 0), or the other way round (at = 3).
Sym3 marginal(float h[36], uint at) {
  const Sym3 other = inverse_of_block(h, 3 - at);
  vec3 c[3];
  for (uint i = 0; i < 3; ++i) {
    c[i] = at == 0 ? coupling_row(h, i) : coupling_column(h, i);
  }
  const vec3 x = mul(other, c[0]);
  const vec3 y = mul(other, c[1]);
  const vec3 z = mul(other, c[2]);
  const Sym3 b = block(h, at);
  return Sym3(b.xx - dot(c[0], x), b.xy - dot(c[0], y), b.xz - dot(c[0], z), b.yy - dot(c[1], y),
              b.yz - dot(c[1], z), b.zz - dot(c[2], z));
}

// The eigenvectors of what is known of translation (at = 0) or rotation (at = 3) when the other is
// free, and how much each match knows of them, on average: 1/m^2.
void write_directions(uint job, float h[36], float isotropic[36], uint at) {
  vec4 pairs[3];
  eigen(marginal(h, at), pairs);
  const Sym3 most = marginal(isotropic, at);
  for (uint k = 0; k < 3; ++k) {
    states[job].directions[at + k] = pairs[k];
    const vec3 v = pairs[k].xyz;
    states[job].support[at + k] = vec2(0.0, pairs[k].w / max(dot(v, mul(most, v)), 1e-30));
  }
}

void write_directions(uint job) {
  float h[36];
  float gradient[6];
  float isotropic[36];
  unpack_system(h, gradient);
  take_out_fictitious(h, gradient);
  isotropic_information(isotropic);
  write_directions(job, h, isotropic, 0);
  write_directions(job, h, isotropic, 3);
}

// Leaves the system `share` of its information on direction v of translation (at = 0) or rotation
// (at = 3): with u, which moves along v while the rest of the pose gives way as the matches let it,
// H <- H - (1 - share) H u (H u)^T / u^T H u. H u has no part in the rest of the pose.
void weaken(inout float h[36], inout float gradient[6], vec3 v, uint at, float share) {
  const Sym3 information = marginal(h, at);
  const vec3 hu = mul(information, v);
  const float curvature = dot(v, hu);
  if (curvature <= 1e-7 * (h[7 * at] + h[7 * at + 7] + h[7 * at + 14])) {
    return;  // nothing to leave
  }
  const vec3 coupled =
      at == 0
          ? v.x * coupling_row(h, 0) + v.y * coupling_row(h, 1) + v.z * coupling_row(h, 2)
          : v.x * coupling_column(h, 0) + v.y * coupling_column(h, 1) + v.z * coupling_column(h, 2);
  const vec3 rest = -mul(inverse_of_block(h, 3 - at), coupled);
  float slope = 0.0;
  for (uint i = 0; i < 3; ++i) {
    slope += v[i] * gradient[at + i] + rest[i] * gradient[3 - at + i];
  }
  const float factor = (1.0 - share) / curvature;
  for (uint i = 0; i < 3; ++i) {
    gradient[at + i] -= factor * slope * hu[i];
    for (uint j = 0; j < 3; ++j) {
      h[6 * (at + i) + at + j] -= factor * hu[i] * hu[j];
    }
  }
}

// The system of a constrained step: the prior added, and weak directions taken out unless the prior
// has been weighed against the matches.
void constrain(uint job, inout float h[36], inout float gradient[6]) {
  take_out_fictitious(h, gradient);
  for (uint k = 0; k < 6 && states[job].constrained == kWithoutWeak; ++k) {
    if (states[job].share[k] < 1.0) {
      weaken(h, gradient, states[job].directions[k].xyz, k < 3 ? 0 : 3, states[job].share[k]);
    }
  }
  const mat3x4 now = states[job].pose;
  const mat3x4 mean = states[job].guess;
  // Log(R R0^T), from the antisymmetric part: |phi| / sin |phi| = 1 + (1 - cos |phi|) / 3 + ...
  vec3 x = vec3(0.0);
  float trace = 0.0;
  for (uint k = 0; k < 3; ++k) {
    x += cross(vec3(mean[0][k], mean[1][k], mean[2][k]), vec3(now[0][k], now[1][k], now[2][k]));
    trace += dot(vec3(mean[0][k], mean[1][k], mean[2][k]), vec3(now[0][k], now[1][k], now[2][k]));
  }
  const vec3 phi = 0.5 * x * (1.0 + (3.0 - trace) / 6.0);
  const float xi[6] = float[6](now[0].w - mean[0].w, now[1].w - mean[1].w, now[2].w - mean[2].w,
                               phi.x, phi.y, phi.z);
  uint k = 0;
  for (uint i = 0; i < 6; ++i) {
    for (uint j = i; j < 6; ++j) {
      const float l = states[job].prior[k];
      ++k;
      h[6 * i + j] += l;
      gradient[i] += l * xi[j];
      if (j > i) {
        h[6 * j + i] += l;
        gradient[j] += l * xi[i];
      }
    }
  }
  // A direction that neither the matches nor the prior hold stays where it is.
  float ridge_t = 1e-6 * (h[0] + h[7] + h[14]);
  float ridge_r = 1e-6 * (h[21] + h[28] + h[35]);
  for (uint i = 0; i < 3; ++i) {
    h[7 * i] = max(h[7 * i], 0.0) + ridge_t + 1e-12;
    h[7 * (i + 3)] = max(h[7 * (i + 3)], 0.0) + ridge_r + 1e-12;
  }
}

#endif
