// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A cell of a hash grid that gathers integer sums: second moments of a surface cell, or mean and
// surface constraint of a voxel of the submap (docs/theory/registration.md).
#ifndef ADIT_SHADERS_SHARED_GAUSSIAN_CELL_H
#define ADIT_SHADERS_SHARED_GAUSSIAN_CELL_H
#include "adit/shaders/shared/prelude.h"
#ifdef __cplusplus
namespace adit::gpu {
#endif

// Keys, owners and slot numbers are stored plus one: a table is free when it is zero.
const uint kFree = 0;

// A cell's 32-bit sums hold so many points whatever their offsets are; one more may overflow them.
// Every kind of cell says what happens then.
const uint kMostCellPoints = 65535;
// Keys of voxel maps name so many cells from the origin, in x and y, and in z (pack_voxel).
const int kVoxelsSideways = 1023;
const int kVoxelsUpwards = 511;

// 48 bytes, read by kernels as three uvec4. Sums are fixed point: offsets from the cell's corner in
// 1/65536 of its edge; the six matrix entries in 1/65536 (surface cells: products of offsets), or,
// of points with a surface, as (entry + 1) * 32768 (voxel maps).
//
// At most kMostCellPoints. A surface cell with more shows no surface, and the points beyond are
// counted as having found no slot. A voxel with more is counted (VoxelMapCounters::crowded); its
// sums are modulo 2^32, so that they are right again once enough points are taken out.
#ifdef ADIT_WIDE
struct GaussianCell {  // the same words, two at once
  uint key;
  uint count;
  uint64_t sum_x_sum_y, sum_z_xx, xy_xz, yy_yz, zz_surfaces;
};
#else
struct GaussianCell {
  uint key;    // packed cell coordinates; kFree: free
  uint count;  // voxel maps: below; above it the planes that face along kFacing
  uint sum_x, sum_y, sum_z;
  uint xx, xy, xz, yy, yz, zz;
  uint surfaces;  // voxel maps: points with a surface, those that the six entries are of; above it
                  // the planes that face against kFacing
};
#endif

// Both faces of a thin wall lie in one voxel. Which of them it shows is told by how many of its
// planes face along an axis that is none of a building's, and how many against it; planes that
// are nearly along it are neither. Counts are at most kMostCellPoints: two share a word.
const float kFacingX = 0.524f;  // of unit length
const float kFacingY = 0.667f;
const float kFacingZ = 0.530f;
const float kUnclearFacing = 0.15f;
const uint kFacingShift = 16;
const uint kCountMask = 65535;

// A voxel's constraint is the mean of its points'; one without a surface counts as this part of a
// point (docs/decisions/0013).
const float kBare = 0.0625;

#ifdef __cplusplus
inline uint points_of(const GaussianCell& voxel) { return voxel.count & kCountMask; }
inline uint surfaces_of(const GaussianCell& voxel) { return voxel.surfaces & kCountMask; }
#endif

// Counts of points, since the map was cleared, of which fewer than 2^32 are added.
struct VoxelMapCounters {
  uint used_slots;    // slots claimed since the map was cleared
  uint failures;      // points that found no slot: 0, or the table is too small
  uint out_of_range;  // points outside the key's range
  uint crowded;       // times that a voxel's count went beyond kMostCellPoints
};

struct VoxelMapAddPush {
  mat3x4 pose;         // T_map_cloud, rows
  float inverse_cell;  // 1 / r_align, 1/m
  uint table_mask;     // slots - 1
  uint point_count;
  uint sign;  // 1: add the cloud; 0xffffffff (-1): take it out again
};

struct VoxelMapFinishPush {
  float cell;  // edge of a voxel, m
  uint slots;
  uint min_points;      // voxels with fewer points are left out
  float least_ratio;    // kGaussians: eigenvalues are raised to this part of the largest
  float least_squared;  // and to this, m^2
};

// What voxel_map_finish.comp makes of a cell, in the same three uvec4: key, count (0: left out),
// then the bits of nine floats: the mean (map frame, m) and a symmetric matrix (xx xy xz yy yz zz).
const uint kGaussians = 0;  // covariance, m^2, of cells with second moments
const uint kPlanes = 1;     // n n^T, of cells with surface constraints

#ifdef __cplusplus
}  // namespace adit::gpu
#endif
#endif
