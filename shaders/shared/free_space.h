// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What submaps say of a tile's voxels: that something is there, or that a ray has gone through.
// Everything is a whole number, so that every device counts the same.
#ifndef ADIT_SHADERS_SHARED_FREE_SPACE_H
#define ADIT_SHADERS_SHARED_FREE_SPACE_H
#include "adit/shaders/shared/prelude.h"
#ifdef __cplusplus
namespace adit::gpu {
#endif

const uint kSpaceBits = 16;  // of a voxel's edge: its fraction in coordinates

// Directions and normals: three whole numbers of ten bits with sign, in 1/511. A ray within 17
// degrees of a voxel's plane says nothing of it: it passes over the ground, and along a wall.
const uint kDirectionBits = 10;
const int kDirectionSteps = 511;
const int kLeastSlant = 78336;  // 0.3 kDirectionSteps^2

// A voxel that holds points, with what the submaps say of it. `seen_by` and `through_by` are the
// numbers, from 1, of the last submap that did, so that each counts once.
struct SpaceVoxel {
  uint key;     // packed voxel; kFree: an empty slot
  uint normal;  // packed; 0: no plane
  uint seen;
  uint through;
  uint seen_by;
  uint through_by;
};

// A point of a submap, and the part of its ray that goes through the tile: samples an edge apart.
// Coordinates are in voxels from the tile's centre.
struct SpaceRay {
  int hit_x, hit_y, hit_z;     // the point's voxel
  int from_x, from_y, from_z;  // the first sample, in 2^-kSpaceBits
  int step_x, step_y, step_z;  // from one to the next, likewise
  uint samples;
  uint direction;  // packed
};

struct SpacePush {
  uint begin;  // first of the submap's rays in the slice
  uint ray_count;
  uint submap;      // its number, from 1
  uint table_mask;  // slots - 1
};

#ifdef __cplusplus
}  // namespace adit::gpu
#endif
#endif
