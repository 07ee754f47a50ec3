// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a place looks like, in bits: a polar view of what stands around it, and its plan
// (docs/theory/loops.md). Everything is whole numbers.
#ifndef ADIT_SHADERS_SHARED_PLACES_H
#define ADIT_SHADERS_SHARED_PLACES_H
#include "adit/shaders/shared/prelude.h"
#ifdef __cplusplus
namespace adit::gpu {
#endif

// The polar view: sectors counted from x towards y, two layers of height each, a bit for each of 32
// rings. Ring k begins at 2^(1 + k / 6) m: from 2 m to 80.6 m.
const uint kPlaceSectors = 64;
const uint kPlaceLayers = 2;
const uint kPolarWords = 128;
// The plan: square cells around the origin, a bit each; rows along x.
const uint kPlanSide = 128;
const uint kPlanRow = 4;  // words
const uint kPlanWords = 512;
// A record: polar view, plan, and the polar view with every bit spread to its neighbours.
const uint kPlanAt = 128;
const uint kSpreadAt = 640;
const uint kPlaceRecord = 768;  // words
// A block of the index has the polar views of so many places, word by word, and then their plans.
const uint kBlockPlaces = 1024;
const uint kBlockPlansAt = 131072;  // words
const uint kBlockWords = 655360;

// Heights (m, from the place's origin): the upper layer begins, and what has no clear surface is
// not yet taken for something that lies on the ground.
const float kUpperLayer = 0.5f;
const float kOffGround = -0.5f;

// How far a correlation shifts the plans, cells to each side, and the places it tries.
const uint kShiftReach = 8;
const uint kShiftSide = 17;
const uint kShifts = 289;
const uint kShiftBits = 9;

struct DescribePush {
  float inverse_cell;  // 1 / edge of a cell of the plan, 1/m
  uint point_count;
  uint place;  // in its block
};

// A match is its hits * kPlaceSectors + turn. Hits are at most 2 kPolarWords 32, every bit on both
// views: 20 bits in all.
struct MatchPush {
  uint place_count;  // of the block
};

// A match is its hits << kShiftBits | shift. Hits are at most 2 a cell, and the cells of a plan
// kPlanSide^2: 24 bits in all. A plan turned by an angle is held against that of a place.
struct PlanJob {
  float cosine, sine;
  uint place;  // in its block
  uint unused0;
};

struct CorrelatePush {
  uint cell_count;
  uint first_job;
};

#ifdef __cplusplus
}  // namespace adit::gpu
#endif
#endif
