// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Which sector and ring of a polar view a point falls into. Comparisons and bits alone, so that
// every device decides alike.
#ifndef ADIT_PLAN_GLSL
#define ADIT_PLAN_GLSL

#include "adit/shaders/shared/places.h"

// tan of 1 to 7 sectors.
const float kTangents[7] = float[](0.09849140336f, 0.19891236738f, 0.30334668361f, 0.41421356237f,
                                   0.53451113595f, 0.66817863792f, 0.82067879083f);

uint sector_of(vec2 p) {
  const vec2 a = abs(p);
  const bool steep = a.y > a.x;
  const float low = min(a.x, a.y);
  const float high = max(a.x, a.y);
  uint sector = 0;
  for (int i = 0; i < 7; ++i) {
    sector += low >= high * kTangents[i] ? 1u : 0u;
  }
  sector = steep ? 15u - sector : sector;
  sector = p.x < 0.0 ? 31u - sector : sector;
  return p.y < 0.0 ? 63u - sector : sector;
}

// 32 and beyond: too near or too far. Rings are thirds of powers of two of the squared range.
uint ring_of(vec2 p) {
  const uint bits = floatBitsToUint(dot(p, p));
  const float mantissa = uintBitsToFloat((bits & 0x7fffffu) | 0x3f800000u);
  const uint third = (mantissa >= 1.25992105f ? 1u : 0u) + (mantissa >= 1.58740105f ? 1u : 0u);
  return 3u * ((bits >> 23) - 129u) + third;
}

#endif
