// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Reading buffers through uniform texel buffers, where specialised to: on lavapipe a fetch of four
// words costs a fifth of the same load from a storage buffer. Devices need not allow more than
// 65536 texels, so every kernel also has the storage buffer; the same bits arrive either way. A
// shader declares, for each such buffer, the storage binding `name` (an array of uvec4) and the
// texel binding `name_texels`.
#ifndef ADIT_TEXELS_GLSL
#define ADIT_TEXELS_GLSL
#extension GL_EXT_samplerless_texture_functions : require

layout(constant_id = 2) const bool kTexels = false;

#define FETCH(name, i) (kTexels ? texelFetch(name##_texels, int(i)) : name[i])

#endif
