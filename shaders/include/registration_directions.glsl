// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the sums of an alignment say of its directions, and how weak ones are taken out of a system
// (docs/theory/registration.md). One thread of the group that finished last.
//
// It works in shared memory, with loops that stay loops: this runs once or twice an alignment, and
// unrolled in registers it took software drivers longer to compile than all other kernels together.
#ifndef ADIT_REGISTRATION_DIRECTIONS_GLSL
#define ADIT_REGISTRATION_DIRECTIONS_GLSL
#extension GL_EXT_control_flow_attributes : require
#include "adit/shaders/include/jacobi.glsl"
#include "adit/shaders/include/registration_step.glsl"

// H, then what isotropic_information() says, then the gradient.
const uint kIsotropicAt = 36;
const uint kGradientAt = 72;
shared float work[kGeometry ? 78 : 1];

// Entry (row, column) of a symmetric 3x3 matrix among its six.
uint entry_of(uint row, uint column) {
  const uint i = min(row, column);
  return i * (5 - i) / 2 + max(row, column);
}

// The information that every match would have by itself if it held its point in all directions
// alike: sum of w J^T J.
void isotropic_information() {
  const uint s = kGeometryAt + 1;
  const uint m = kGeometryAt + 4;
  [[dont_unroll]] for (uint n = 0; n < 9; ++n) {
    const uint i = n / 3;
    const uint j = n % 3;
    // -[s]x in the upper right, its transpose in the lower left; trace(m) I - m.
    const float skew = system[s + (i == j ? 0 : 3 - i - j)];
    const float upper = i == j ? 0.0 : (j + 3 - i) % 3 == 1 ? skew : -skew;
    const float trace = system[m + (i == 0 ? 3 : 0)] + system[m + (i == 2 ? 3 : 5)];
    work[kIsotropicAt + 6 * i + j] = i == j ? system[kGeometryAt] : 0.0;
    work[kIsotropicAt + 6 * i + 3 + j] = upper;
    work[kIsotropicAt + 6 * (3 + j) + i] = upper;
    work[kIsotropicAt + 6 * (3 + i) + 3 + j] = i == j ? trace : -system[m + entry_of(i, j)];
  }
}

// The system without the information that regularised covariances claim in every direction, and
// likewise the gradient.
void unpack_without_fictitious() {
  [[dont_unroll]] for (uint n = 0; n < 36; ++n) {
    const uint i = min(n / 6, n % 6);
    const uint j = max(n / 6, n % 6);
    work[n] = system[i * (11 - i) / 2 + j] - push.fictitious * work[kIsotropicAt + n];
  }
  [[dont_unroll]] for (uint i = 0; i < 6; ++i) {
    work[kGradientAt + i] = system[21 + i] + push.fictitious * system[kGeometryAt + 10 + i];
  }
}

// Of the matrix at `m`: the diagonal block at `at`, of translation (0) or rotation (3).
Sym3 block(uint m, uint at) {
  const uint d = m + 7 * at;
  return Sym3(work[d], work[d + 1], work[d + 2], work[d + 7], work[d + 8], work[d + 14]);
}

// A row of the block between translation and rotation; from rotation's side, a column.
vec3 coupling(uint m, uint at, uint i) {
  const uint first = m + (at == 0 ? 6 * i + 3 : 3 + i);
  const uint stride = at == 0 ? 1 : 6;
  return vec3(work[first], work[first + stride], work[first + 2 * stride]);
}

Sym3 inverse_of_block(uint m, uint at) {
  Sym3 b = block(m, at);
  const float ridge = 1e-6 * (b.xx + b.yy + b.zz) + 1e-20;
  b.xx += ridge;
  b.yy += ridge;
  b.zz += ridge;
  return inverse(b);
}

// Information on translation once rotation is free (at = 0), or the other way round (at = 3).
Sym3 marginal(uint m, uint at) {
  const Sym3 other = inverse_of_block(m, 3 - at);
  vec3 c[3];
  for (uint i = 0; i < 3; ++i) {
    c[i] = coupling(m, at, i);
  }
  const vec3 x = mul(other, c[0]);
  const vec3 y = mul(other, c[1]);
  const vec3 z = mul(other, c[2]);
  const Sym3 b = block(m, at);
  return Sym3(b.xx - dot(c[0], x), b.xy - dot(c[0], y), b.xz - dot(c[0], z), b.yy - dot(c[1], y),
              b.yz - dot(c[1], z), b.zz - dot(c[2], z));
}

// The eigenvectors of what is known of translation (at = 0) or rotation (at = 3) when the other is
// free, and how much each match knows of them, on average: 1/m^2.
void write_directions(uint job) {
  [[dont_unroll]] for (uint at = 0; at < 6; at += 3) {
    vec4 pairs[3];
    eigen(marginal(0, at), pairs);
    const Sym3 most = marginal(kIsotropicAt, at);
    for (uint k = 0; k < 3; ++k) {
      states[job].directions[at + k] = pairs[k];
      const vec3 v = pairs[k].xyz;
      states[job].support[at + k] = vec2(0.0, pairs[k].w / max(dot(v, mul(most, v)), 1e-30));
    }
  }
}

// Leaves the system `share` of its information on direction v of translation (at = 0) or rotation
// (at = 3): with u, which moves along v while the rest of the pose gives way as the matches let it,
// H <- H - (1 - share) H u (H u)^T / u^T H u. H u has no part in the rest of the pose.
void weaken(vec3 v, uint at, float share) {
  const vec3 hu = mul(marginal(0, at), v);
  const float curvature = dot(v, hu);
  if (curvature <= 1e-7 * (work[7 * at] + work[7 * at + 7] + work[7 * at + 14])) {
    return;  // nothing to leave
  }
  const vec3 coupled =
      v.x * coupling(0, at, 0) + v.y * coupling(0, at, 1) + v.z * coupling(0, at, 2);
  const vec3 rest = -mul(inverse_of_block(0, 3 - at), coupled);
  float slope = 0.0;
  for (uint i = 0; i < 3; ++i) {
    slope += v[i] * work[kGradientAt + at + i] + rest[i] * work[kGradientAt + 3 - at + i];
  }
  const float factor = (1.0 - share) / curvature;
  [[dont_unroll]] for (uint n = 0; n < 12; ++n) {
    const uint i = n >> 2;
    const uint j = n & 3u;
    const float hu_i = i == 0 ? hu.x : i == 1 ? hu.y : hu.z;
    const float hu_j = j == 0 ? hu.x : j == 1 ? hu.y : j == 2 ? hu.z : slope;
    const uint to = j == 3 ? kGradientAt + at + i : 6 * (at + i) + at + j;
    work[to] -= j == 3 ? factor * slope * hu_i : factor * hu_i * hu_j;
  }
}

// The system of a constrained step: weak directions taken out, the prior added.
void constrain(uint job) {
  [[dont_unroll]] for (uint k = 0; k < 6; ++k) {
    if (states[job].share[k] < 1.0) {
      weaken(states[job].directions[k].xyz, k < 3 ? 0 : 3, states[job].share[k]);
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
  const uint xi = kIsotropicAt;  // not needed any more
  for (uint k = 0; k < 3; ++k) {
    work[xi + k] = now[k].w - mean[k].w;
    work[xi + 3 + k] = phi[k];
  }
  uint k = 0;
  [[dont_unroll]] for (uint n = 0; n < 36; ++n) {
    const uint i = n / 6;
    const uint j = n % 6;
    if (j >= i) {
      const float l = states[job].prior[k];
      ++k;
      work[n] += l;
      work[kGradientAt + i] += l * work[xi + j];
      if (j > i) {
        work[6 * j + i] += l;
        work[kGradientAt + j] += l * work[xi + i];
      }
    }
  }
  // A direction that neither the matches nor the prior hold stays where it is.
  const float ridge_t = 1e-6 * (work[0] + work[7] + work[14]);
  const float ridge_r = 1e-6 * (work[21] + work[28] + work[35]);
  [[dont_unroll]] for (uint i = 0; i < 6; ++i) {
    work[7 * i] = max(work[7 * i], 0.0) + (i < 3 ? ridge_t : ridge_r) + 1e-12;
  }
}

#endif
