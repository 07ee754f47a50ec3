// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "adit/engine/buffer.hpp"
#include "adit/engine/kernel.hpp"
#include "adit/engine/kernels/launch.hpp"
#include "adit/engine/recorder.hpp"
#include "adit/shaders/shared/places.h"

namespace adit::engine {

/// What is to be described: uvec4 (bits of x, y, z, packed surface) a point, m, z up.
struct PlaceCloud {
  Slice points;
  uint32_t count = 0;
  double cell = 0.0;  ///< edge of a cell of the plan, m
};

/// A plan's cells turned and shifted over those of places.
struct PlanArguments {
  Slice cells;  ///< in: vec2 a cell: its centre from the origin, in cells
  uint32_t cell_count = 0;
  Slice jobs;  ///< in: gpu::PlanJob
  uint32_t first_job = 0;
  uint32_t job_count = 0;
  Slice block;    ///< in: that of the jobs' places
  Slice matches;  ///< out: uint a job: hits << gpu::kShiftBits | shift
};

/// At most so many cells of a plan are correlated: lavapipe's loops (least_groups()) take no more.
inline constexpr uint32_t kMostPlanCells = 4096;

/// Describes places and compares descriptions (docs/theory/loops.md). An index is made of blocks of
/// gpu::kBlockPlaces places. All of it is whole numbers: the order of points does not matter.
class PlaceKernels {
 public:
  explicit PlaceKernels(Context& context);

  static constexpr uint64_t block_bytes() { return uint64_t{gpu::kBlockWords} * sizeof(uint32_t); }
  static constexpr uint64_t record_bytes() {
    return uint64_t{gpu::kPlaceRecord} * sizeof(uint32_t);
  }

  /// Writes the record, and place number `place` of the block. Ends without a barrier.
  void record_describe(Recorder& recorder, const PlaceCloud& cloud, Slice record, Slice block,
                       uint32_t place) const;
  /// Writes for each of the block's first `count` places a uint: hits * gpu::kPlaceSectors + turn.
  /// A bearing in the place is that in the record less so many sectors. Ends without a barrier.
  void record_match(Recorder& recorder, Slice record, Slice block, uint32_t count,
                    Slice matches) const;
  /// Ends without a barrier.
  void record_correlate(Recorder& recorder, const PlanArguments& arguments) const;

 private:
  LaunchShape shape_;
  Kernel describe_;
  Kernel match_;
  Kernel correlate_;
};

}  // namespace adit::engine
