// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The submap of a keyframe: clouds merged into one, and its surfaces.
#ifndef ADIT_SHADERS_SHARED_SUBMAP_H
#define ADIT_SHADERS_SHARED_SUBMAP_H
#include "adit/shaders/shared/prelude.h"
#ifdef __cplusplus
namespace adit::gpu {
#endif

// `inverted_nearest` of a cell is the complement of the squeezed range to the sensor that was
// nearest, in 1 / kRangeSteps m, in its upper bits, and of that sensor's sweep in these lower ones.
const uint kSweepBits = 10;
const float kRangeSteps = 2048.0f;

// One cell of the submap while clouds are merged. Sums are offsets from the cell's corner in
// 1/65536 of its edge: integers, so that any order of addition gives the same bits. Of at most
// kMostCellPoints (gaussian_cell.h): beyond, the host takes the cell's centre and counts the cell.
struct MergeCell {
  uint key;  // packed cell coordinates; kFree: free
  uint count;
  uint sum_x, sum_y, sum_z;
  uint inverted_nearest;
};

// Counts of points, since the table was cleared, of which fewer than 2^32 are added.
struct MergeCounters {
  uint used_slots;    // slots claimed since the table was cleared
  uint failures;      // points that found no slot: 0, or the table is too small
  uint out_of_range;  // points outside the key's range
  uint unused0;
};

struct MergePush {
  mat3x4 pose;         // T_submap_lidar, rows
  float inverse_cell;  // 1 / r_submap, 1/m
  uint table_mask;     // slots - 1
  uint begin;          // first of the cloud's points in the slice
  uint point_count;
  uint sweep;  // its number in the submap
};

struct SubmapSurfacePush {
  uint point_count;
  float inverse_surface_cell;  // 1 / edge of a level-0 surface cell, 1/m
  float level_factor;          // (2.5 beam_spacing / edge of level 0)^2, 1/m^2
  uint surface_mask;           // slots of the surface table - 1
};

#ifdef __cplusplus
}  // namespace adit::gpu
#endif
#endif
