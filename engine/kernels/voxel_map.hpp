// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "engine/buffer.hpp"
#include "engine/kernel.hpp"
#include "engine/kernels/launch.hpp"
#include "engine/recorder.hpp"
#include "shaders/shared/gaussian_cell.h"

namespace adit::engine {

/// A Gaussian voxel map on the device: a hash table of gpu::GaussianCell. Coordinates are in the
/// map's own local frame (m); voxels reach 1023 cells from its origin in x and y, 511 in z.
struct VoxelMapView {
  Slice table;
  Slice counters;           ///< gpu::VoxelMapCounters
  double voxel_size = 0.0;  ///< m

  /// Slots of the table; a power of two.
  uint32_t slots() const { return static_cast<uint32_t>(table.bytes / sizeof(gpu::GaussianCell)); }
};

/// Fills Gaussian voxel maps. Counts, means and constraints are exact integer sums, so that the map
/// does not depend on the order of points or clouds, and a cloud can be taken out without a trace.
class VoxelMapKernels {
 public:
  explicit VoxelMapKernels(Context& context);

  static uint64_t table_bytes(uint32_t slots) {
    return uint64_t{slots} * sizeof(gpu::GaussianCell);
  }

  /// Empties the map. Ends with a barrier.
  void record_clear(Recorder& recorder, const VoxelMapView& map) const;
  /// Adds `count` points of a surface cloud (Preprocess), moved by T_map_cloud (rows of its 3x4
  /// matrix).
  void record_add(Recorder& recorder, const VoxelMapView& map, Slice surface_cloud, uint32_t count,
                  const gpu::mat3x4& T_map_cloud) const;
  /// Takes out what record_add() put in with the same arguments.
  void record_remove(Recorder& recorder, const VoxelMapView& map, Slice surface_cloud,
                     uint32_t count, const gpu::mat3x4& T_map_cloud) const;

 private:
  void record(Recorder& recorder, const VoxelMapView& map, Slice surface_cloud, uint32_t count,
              const gpu::mat3x4& T_map_cloud, uint32_t sign) const;

  LaunchShape shape_;
  bool texels_;
  Kernel add_;
};

}  // namespace adit::engine
