// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// All eigenvectors of a symmetric 3x3 matrix, whatever its eigenvalues (sym3.glsl finds one of a
// simple eigenvalue, faster).
#ifndef ADIT_JACOBI_GLSL
#define ADIT_JACOBI_GLSL
#include "adit/shaders/include/sym3.glsl"

// One Jacobi rotation that zeroes entry (p, q) of the symmetric a; v gathers the eigenvectors as
// columns.
void rotate(inout float a[9], inout float v[9], uint p, uint q) {
  const float apq = a[3 * p + q];
  if (apq == 0.0) {
    return;
  }
  const float theta = (a[4 * q] - a[4 * p]) / (2.0 * apq);
  const float t = (theta < 0.0 ? -1.0 : 1.0) / (abs(theta) + sqrt(theta * theta + 1.0));
  const float c = inversesqrt(t * t + 1.0);
  const float s = t * c;
  for (uint k = 0; k < 3; ++k) {
    const float kp = a[3 * k + p];
    const float kq = a[3 * k + q];
    a[3 * k + p] = c * kp - s * kq;
    a[3 * k + q] = s * kp + c * kq;
  }
  for (uint k = 0; k < 3; ++k) {
    const float pk = a[3 * p + k];
    const float qk = a[3 * q + k];
    a[3 * p + k] = c * pk - s * qk;
    a[3 * q + k] = s * pk + c * qk;
    const float vp = v[3 * k + p];
    const float vq = v[3 * k + q];
    v[3 * k + p] = c * vp - s * vq;
    v[3 * k + q] = s * vp + c * vq;
  }
}

// Eigenvectors (orthonormal whatever the matrix) with their eigenvalues, ascending. Jacobi, scaled
// so that nothing over- or underflows: four sweeps are exact to float32.
void eigen(Sym3 m, out vec4 pairs[3]) {
  const float scale =
      max(max(max(abs(m.xx), abs(m.yy)), abs(m.zz)), max(max(abs(m.xy), abs(m.xz)), abs(m.yz)));
  const Sym3 u = scaled(m, 1.0 / max(scale, 1e-30));
  float a[9] = float[9](u.xx, u.xy, u.xz, u.xy, u.yy, u.yz, u.xz, u.yz, u.zz);
  float v[9] = float[9](1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
  for (uint sweep = 0; sweep < 4; ++sweep) {
    rotate(a, v, 0, 1);
    rotate(a, v, 0, 2);
    rotate(a, v, 1, 2);
  }
  for (uint k = 0; k < 3; ++k) {
    pairs[k] = vec4(normalize(vec3(v[k], v[3 + k], v[6 + k])), a[4 * k] * scale);
  }
  for (uint pass = 0; pass < 2; ++pass) {
    for (uint k = 0; k < 2; ++k) {
      if (pairs[k].w > pairs[k + 1].w) {
        const vec4 lower = pairs[k + 1];
        pairs[k + 1] = pairs[k];
        pairs[k] = lower;
      }
    }
  }
}

#endif
