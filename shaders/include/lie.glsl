// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// SO(3) on the device, in the convention of slam/core/lie.hpp, without sin, cos or acos.
#ifndef ADIT_LIE_GLSL
#define ADIT_LIE_GLSL

// Exp(phi), rows in the place of columns (that is, its transpose). The quaternion's series in
// |phi|^2 is exact to float32 up to |phi| = 0.5; beyond that the step is merely a rotation about
// the same axis by nearly the same angle.
mat3 so3_exp_rows(vec3 phi) {
  const float a = 0.25 * dot(phi, phi);
  const float w = 1.0 - a * (0.5 - a * (1.0 / 24.0 - a / 720.0));
  const float s = 0.5 * (1.0 - a * (1.0 / 6.0 - a * (1.0 / 120.0 - a / 5040.0)));
  const vec4 q = normalize(vec4(s * phi, w));
  return mat3(1.0 - 2.0 * (q.y * q.y + q.z * q.z), 2.0 * (q.x * q.y - q.w * q.z),
              2.0 * (q.x * q.z + q.w * q.y), 2.0 * (q.x * q.y + q.w * q.z),
              1.0 - 2.0 * (q.x * q.x + q.z * q.z), 2.0 * (q.y * q.z - q.w * q.x),
              2.0 * (q.x * q.z - q.w * q.y), 2.0 * (q.y * q.z + q.w * q.x),
              1.0 - 2.0 * (q.x * q.x + q.y * q.y));
}

// Rows in the place of columns, too: the rotation nearest to r by Gram-Schmidt: keeps a product of
// many rotations on SO(3).
mat3 orthonormal_rows(mat3 r) {
  const vec3 x = normalize(r[0]);
  const vec3 y = normalize(r[1] - dot(r[1], x) * x);
  return mat3(x, y, cross(x, y));
}

#endif
