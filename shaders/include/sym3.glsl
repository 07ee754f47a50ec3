// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Symmetric 3x3 matrices as (xx, xy, xz, yy, yz, zz).
#ifndef ADIT_SYM3_GLSL
#define ADIT_SYM3_GLSL

struct Sym3 {
  float xx, xy, xz, yy, yz, zz;
};

vec3 mul(Sym3 m, vec3 v) {
  return vec3(m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
              m.xz * v.x + m.yz * v.y + m.zz * v.z);
}

Sym3 add(Sym3 a, Sym3 b) {
  return Sym3(a.xx + b.xx, a.xy + b.xy, a.xz + b.xz, a.yy + b.yy, a.yz + b.yz, a.zz + b.zz);
}

Sym3 scaled(Sym3 a, float s) {
  return Sym3(a.xx * s, a.xy * s, a.xz * s, a.yy * s, a.yz * s, a.zz * s);
}

// By cofactors. For the sums of regularised covariances (eigenvalues within [2 epsilon, 2]) the
// relative error in float32 stays below 1e-4.
Sym3 inverse(Sym3 m) {
  const float c00 = m.yy * m.zz - m.yz * m.yz;
  const float c01 = m.xz * m.yz - m.xy * m.zz;
  const float c02 = m.xy * m.yz - m.xz * m.yy;
  const float scale = 1.0 / (m.xx * c00 + m.xy * c01 + m.xz * c02);
  return Sym3(c00 * scale, c01 * scale, c02 * scale, (m.xx * m.zz - m.xz * m.xz) * scale,
              (m.xy * m.xz - m.xx * m.yz) * scale, (m.xx * m.yy - m.xy * m.xy) * scale);
}

// Eigenvalues of a positive semi-definite matrix, ascending. The smallest is the limit of Newton's
// method from 0 on the characteristic polynomial, which rises and is concave left of its first
// root, so that no step overshoots; the others follow from a quadratic. Only + - * / and sqrt,
// which every device rounds well (GLSL's acos and cos, that the trigonometric form would need, are
// coarse). Absolute error about 1e-7 of the trace.
vec3 eigenvalues(Sym3 m) {
  const float trace = m.xx + m.yy + m.zz;
  const float c00 = m.yy * m.zz - m.yz * m.yz;
  const float minors = c00 + (m.xx * m.zz - m.xz * m.xz) + (m.xx * m.yy - m.xy * m.xy);
  const float determinant =
      m.xx * c00 + m.xy * (m.xz * m.yz - m.xy * m.zz) + m.xz * (m.xy * m.yz - m.yy * m.xz);
  float low = 0.0;
  for (int step = 0; step < 8; ++step) {
    const float value = ((low - trace) * low + minors) * low - determinant;
    const float slope = (3.0 * low - 2.0 * trace) * low + minors;
    low += slope > 0.0 ? max(-value, 0.0) / slope : 0.0;
  }
  const float mean = 0.5 * (trace - low);
  const float product = minors - low * (trace - low);
  const float high = mean + sqrt(max(mean * mean - product, 0.0));
  return vec3(low, max(trace - low - high, low), high);
}

// The eigenvector of a simple eigenvalue: the longest cross product of two rows of m - value I.
// Zero if there is none (the eigenvalue is not simple).
vec3 eigenvector(Sym3 m, float value) {
  const vec3 r0 = vec3(m.xx - value, m.xy, m.xz);
  const vec3 r1 = vec3(m.xy, m.yy - value, m.yz);
  const vec3 r2 = vec3(m.xz, m.yz, m.zz - value);
  const vec3 a = cross(r0, r1);
  const vec3 b = cross(r0, r2);
  const vec3 c = cross(r1, r2);
  const vec3 ab = dot(a, a) > dot(b, b) ? a : b;
  const vec3 longest = dot(ab, ab) > dot(c, c) ? ab : c;
  return longest * inversesqrt(max(dot(longest, longest), 1e-30));
}

#endif
