// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The surface constraint of a voxel, out of the three words of its GaussianCell.
#ifndef ADIT_CONSTRAINT_GLSL
#define ADIT_CONSTRAINT_GLSL
#include "adit/shaders/include/sym3.glsl"
#include "adit/shaders/shared/gaussian_cell.h"

// Mean of P over the points with a surface, and kBare of those without, whose P is 0.
Sym3 mean_constraint(uvec4 head, uvec4 middle, uvec4 tail) {
  const float surfaces = float(tail.w & kCountMask);
  const float weights = surfaces + kBare * (float(head.y & kCountMask) - surfaces);
  const float share = surfaces / max(weights, kBare);
  const float scale = share / (32768.0 * max(surfaces, 1.0));
  return Sym3(float(middle.y) * scale - share, float(middle.z) * scale - share,
              float(middle.w) * scale - share, float(tail.x) * scale - share,
              float(tail.y) * scale - share, float(tail.z) * scale - share);
}

// Shares of a voxel's surfaces that face along kFacing, and against it.
vec2 faces_of(uvec4 head, uvec4 tail) {
  return vec2(head.y >> kFacingShift, tail.w >> kFacingShift) / float(max(tail.w & kCountMask, 1u));
}

#endif
