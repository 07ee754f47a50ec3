// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Neighbouring 32-bit words that are read, written and added to as one word of 64 bits. A kernel
// that includes this is built a second time with ADIT_WIDE defined, for software devices: lavapipe
// loops over the lanes once a word. It also begins with
//
//   #ifdef ADIT_WIDE
//   #extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
//   #extension GL_EXT_shader_atomic_int64 : require
//   #endif
#ifndef ADIT_WIDE_GLSL
#define ADIT_WIDE_GLSL

#ifdef ADIT_WIDE
#define PAIR uint64_t
#define PAIR_OF(words) pack64(words)
#define WORDS_OF(pair) unpack32(pair)
// Adds to two neighbouring members of a cell. A sum that overflows spoils its neighbour as well.
#define ADD_PAIR(cell, a, b, words) atomicAdd(cell.a##_##b, pack64(words))
#define ADD_LOW(cell, a, b, word) atomicAdd(cell.a##_##b, uint64_t(word))  // to the first of them
#else
#define PAIR uvec2
#define PAIR_OF(words) (words)
#define WORDS_OF(pair) (pair)
#define ADD_PAIR(cell, a, b, words) \
  atomicAdd(cell.a, (words).x);     \
  atomicAdd(cell.b, (words).y)
#define ADD_LOW(cell, a, b, word) atomicAdd(cell.a, word)
#endif
#endif
