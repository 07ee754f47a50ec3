// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Hashing and packing of cell coordinates. Everything is exact integer arithmetic but for one
// correctly rounded multiplication, so every device and the host put a point into the same cell.
#ifndef ADIT_HASH_GLSL
#define ADIT_HASH_GLSL

#include "adit/shaders/shared/gaussian_cell.h"

// How a probe loop must be written: test at the top, results only in variables that the loop
// carries. After `do { ... } while (...)`, lavapipe (Mesa 22.3) and SwiftShader give threads that
// left the loop early what a load or an atomic returned to them while they were inactive in a later
// iteration of the others.
const uint kMaxProbes = 128u;  // at load 0.5 a chain reaches this once in 10^12 keys

// MurmurHash3's finaliser: every input bit reaches every output bit.
uint mix32(uint h) {
  h ^= h >> 16;
  h *= 0x85ebca6bu;
  h ^= h >> 13;
  h *= 0xc2b2ae35u;
  h ^= h >> 16;
  return h;
}

uint hash_cell(ivec3 c) { return mix32(uint(c.z) ^ mix32(uint(c.y) ^ mix32(uint(c.x)))); }

bool is_finite(vec3 p) {
  const uvec3 exponent = floatBitsToUint(p) & 0x7f800000u;
  return all(notEqual(exponent, uvec3(0x7f800000u)));
}

// Offset of scaled coordinates from their cell's corner, in 1/65536 of the edge.
uvec3 fixed_offset(vec3 scaled, vec3 corner) {
  return min(uvec3((scaled - corner) * 65536.0), uvec3(65535u));
}

// The first point of a run of raw points: its cell's slot and its place in its block of at most 32
// points. Slots are below 2^27: a table of more would not fit a storage buffer.
struct RunHead {
  uint slot;
  uint first;  // raw index
};

uint pack_run_head(uint slot, uint first) { return (slot << 5) | (first & 31u); }

RunHead unpack_run_head(uint head, uint block_begin) {
  return RunHead(head >> 5, (block_begin & ~31u) | (head & 31u));
}

// Voxel maps: 11 bits for x and y, 10 for z, biased. Cells outside give kFree.
uint pack_voxel(ivec3 c) {
  const uvec3 biased =
      uvec3(c + ivec3(kVoxelsSideways + 1, kVoxelsSideways + 1, kVoxelsUpwards + 1));
  const bool inside = biased.x < 2047u && biased.y < 2048u && biased.z < 1024u;
  return inside ? ((biased.x << 21) | (biased.y << 10) | biased.z) + 1u : kFree;
}

#endif
