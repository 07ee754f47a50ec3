// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Down-sampling and surface estimation of one sweep: what the kernels and the host share.
#ifndef ADIT_SHADERS_SHARED_PREPROCESS_H
#define ADIT_SHADERS_SHARED_PREPROCESS_H
#include "adit/shaders/shared/prelude.h"
#ifdef __cplusplus
namespace adit::gpu {
#endif

// One cell of the down-sampling grid while it is being filled. Sums are offsets from the cell's
// corner in 1/65536 of its edge: integers, so that any order of addition gives the same bits. They
// hold every sweep whose table fits a storage buffer, which is less than 4 GiB: the table has two
// slots a point, so there are at most 2^25 points of less than 2^16 each, and a sum reaches 2^32
// fewer than 2^10 times.
#ifdef ADIT_WIDE
struct InputCell {  // sums of 64 bits and fewer than 2^24 points, which is all that fits
  uint owner;
  uint unused0;
  uint64_t count_sum_x;  // the count above kWideSumBits
  uint64_t sum_y;
  uint64_t sum_z;
};
#else
struct InputCell {
  uint owner;  // 1 + the smallest index of its raw points, its place in the output; kFree: free
  uint count;
  uint sum_x, sum_y, sum_z;  // modulo 2^32
  uint carries;              // times that they reached 2^32: kCarryBits each, x the lowest
  uint unused0, unused1;     // 32 bytes never straddle a line of a cache
};
#endif

const uint kCarryBits = 10;
const uint kWideSumBits = 40;

// What the kernels of one sweep report: counts of its points, of which there are at most 2^25.
// Zeroed by the host before the sweep.
struct SweepCounters {
  uint valid_points;      // raw points left after NaN, no-return and range clipping
  uint cloud_points;      // points of the down-sampled cloud
  uint input_failures;    // raw points that found no slot: 0, or the table is too small
  uint surface_failures;  // surface cells that found no slot for a point: 0, or the table is too
                          // small; and points beyond what a surface cell's sums hold
};

struct DownsamplePush {
  uint point_count;
  uint table_mask;     // slots - 1, slots a power of two
  float inverse_cell;  // 1 / r_input, 1/m
  float min_squared;   // c_min^2, m^2
  float max_squared;   // c_max^2, m^2
};

struct CountPush {
  uint point_count;
};

struct EmitPush {
  uint point_count;
  float cell;                  // r_input, m
  float inverse_cell;          // 1 / r_input, 1/m
  float inverse_surface_cell;  // 1 / edge of a level-0 surface cell, 1/m
  float level_factor;          // (2.5 beam_spacing / edge of level 0)^2, 1/m^2
  uint surface_mask;           // slots of the surface table - 1
};

struct SurfacePush {
  float inverse_surface_cell;
  float level_factor;
  uint surface_mask;
};

#ifdef __cplusplus
}  // namespace adit::gpu
#endif
#endif
