// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "adit/engine/buffer.hpp"
#include "adit/engine/kernel.hpp"
#include "adit/engine/kernels/launch.hpp"
#include "adit/engine/kernels/preprocess.hpp"
#include "adit/engine/recorder.hpp"
#include "adit/shaders/shared/submap.h"

namespace adit::engine {

/// Sweeps that one submap can tell apart.
inline constexpr uint32_t kMostMergedSweeps = 1U << gpu::kSweepBits;

/// Where clouds are merged: a hash table of gpu::MergeCell. Coordinates are in the submap's own
/// frame (m); cells reach gpu::kVoxelsSideways from its origin in x and y,
/// gpu::kVoxelsUpwards in z.
struct MergeView {
  Slice table;
  Slice counters;           ///< gpu::MergeCounters
  double voxel_size = 0.0;  ///< r_submap, m

  /// Slots of the table; a power of two.
  uint32_t slots() const { return static_cast<uint32_t>(table.bytes / sizeof(gpu::MergeCell)); }
};

/// A cloud to merge: vec4 (x, y, z, unused) a point, lidar frame.
struct MergeCloud {
  Slice points;
  uint32_t begin = 0;  ///< first point in the slice
  uint32_t count = 0;
  uint32_t sweep = 0;  ///< its number in the submap, less than kMostMergedSweeps
  gpu::mat3x4 T_submap_lidar{};
};

/// A merged cloud whose surfaces are wanted.
struct SubmapSurfaceArguments {
  uint32_t count = 0;
  Slice points;         ///< in: uvec4 (bits of x, y, z, number of its sensor) a point
  Slice sensors;        ///< in: vec4 a sensor: where it was, m; w unused
  Slice surface_cloud;  ///< out: uvec4 (bits of x, y, z, packed surface) a point
};

/// The submaps of keyframes: clouds are merged into cells, and the surfaces of what came of it are
/// estimated, each seen from its own sensor's place. All sums are integers: the order of points and
/// clouds does not matter.
class SubmapMerge {
 public:
  explicit SubmapMerge(Context& context);

  static uint64_t table_bytes(uint32_t slots) { return uint64_t{slots} * sizeof(gpu::MergeCell); }

  /// Empties the table. Ends with a barrier.
  void record_clear(Recorder& recorder, const MergeView& view) const;
  /// Adds a cloud. Ends without a barrier: clouds may be added at the same time.
  void record_add(Recorder& recorder, const MergeView& view, const MergeCloud& cloud) const;

  static uint64_t surface_scratch_bytes(uint32_t points);
  /// `settings` are those of the sweeps, with r_submap for r_input. Ends without a barrier.
  void record_surfaces(Recorder& recorder, const PreprocessSettings& settings,
                       const SubmapSurfaceArguments& arguments, Slice scratch) const;

 private:
  LaunchShape shape_;
  Kernel merge_;
  Kernel cells_;
  Kernel surfaces_;
};

}  // namespace adit::engine
