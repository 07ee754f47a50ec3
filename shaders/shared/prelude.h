// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the headers in this folder need to be read by GLSL and C++ alike. On the device the structs
// are in scalar layout (GL_EXT_scalar_block_layout), which is C++'s layout for these types. Names
// and meanings are GLSL's. (Include guards, since GLSL has no #pragma once.)
#ifndef ADIT_SHADERS_SHARED_PRELUDE_H
#define ADIT_SHADERS_SHARED_PRELUDE_H

#ifdef __cplusplus
#include <cstdint>

namespace adit::gpu {

using uint = uint32_t;

struct vec2 {
  float x, y;
};
struct vec3 {
  float x, y, z;
};
struct vec4 {
  float x, y, z, w;
};
struct ivec2 {
  int32_t x, y;
};
struct ivec3 {
  int32_t x, y, z;
};
struct ivec4 {
  int32_t x, y, z, w;
};
struct uvec2 {
  uint x, y;
};
struct uvec3 {
  uint x, y, z;
};
struct uvec4 {
  uint x, y, z, w;
};

/// Three columns of four. Holds a pose as the rows of its 3x4 matrix, so that GLSL applies it as
/// vec4(p, 1) * T.
struct mat3x4 {
  vec4 rows[3];
};

}  // namespace adit::gpu
#endif

#endif
