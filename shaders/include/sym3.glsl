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

// By cofactors. For the sums of regularised covariances (eigenvalues within [2 epsilon, 2]) the relative
// error in float32 stays below 1e-4.
Sym3 inverse(Sym3 m) {
  const float c00 = m.yy * m.zz - m.yz * m.yz;
  const float c01 = m.xz * m.yz - m.xy * m.zz;
  const float c02 = m.xy * m.yz - m.xz * m.yy;
  const float scale = 1.0 / (m.xx * c00 + m.xy * c01 + m.xz * c02);
  return Sym3(c00 * scale, c01 * scale, c02 * scale, (m.xx * m.zz - m.xz * m.xz) * scale,
              (m.xy * m.xz - m.xx * m.yz) * scale, (m.xx * m.yy - m.xy * m.xy) * scale);
}

struct Eigen3 {
  vec3 values;   // unordered
  mat3 vectors;  // columns, in the order of the values
};

// One Jacobi rotation that zeroes a(p, q); r is the third index.
void rotate(inout float app, inout float aqq, inout float apq, inout float arp, inout float arq, inout vec3 vp,
            inout vec3 vq) {
  const float theta = 0.5 * (aqq - app);
  const float denominator = abs(theta) + sqrt(theta * theta + apq * apq);
  const float t = (theta < 0.0 ? -apq : apq) / max(denominator, 1e-30);
  const float c = inversesqrt(t * t + 1.0);
  const float s = t * c;
  app -= t * apq;
  aqq += t * apq;
  apq = 0.0;
  const vec2 row = vec2(arp, arq);
  arp = c * row.x - s * row.y;
  arq = s * row.x + c * row.y;
  const vec3 column = vp;
  vp = c * column - s * vq;
  vq = s * column + c * vq;
}

// Cyclic Jacobi, four sweeps: only + - * / and sqrt, which every device rounds well (GLSL's acos does not).
Eigen3 eigen(Sym3 m) {
  vec3 v0 = vec3(1.0, 0.0, 0.0);
  vec3 v1 = vec3(0.0, 1.0, 0.0);
  vec3 v2 = vec3(0.0, 0.0, 1.0);
  for (int sweep = 0; sweep < 4; ++sweep) {
    rotate(m.xx, m.yy, m.xy, m.xz, m.yz, v0, v1);
    rotate(m.xx, m.zz, m.xz, m.xy, m.yz, v0, v2);
    rotate(m.yy, m.zz, m.yz, m.xy, m.xz, v1, v2);
  }
  return Eigen3(vec3(m.xx, m.yy, m.zz), mat3(v0, v1, v2));
}

#endif
