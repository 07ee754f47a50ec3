// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "adit/engine/buffer.hpp"
#include "adit/engine/kernel.hpp"
#include "adit/engine/kernels/launch.hpp"
#include "adit/engine/recorder.hpp"
#include "adit/shaders/shared/gaussian_cell.h"

namespace adit::engine {

/// A Gaussian voxel map on the device: a hash table of gpu::GaussianCell. Coordinates are in the
/// map's own local frame (m); voxels reach gpu::kVoxelsSideways cells from its origin in x
/// and y, gpu::kVoxelsUpwards in z.
struct VoxelMapView {
  Slice table;
  Slice counters;           ///< gpu::VoxelMapCounters
  double voxel_size = 0.0;  ///< m

  /// Slots of the table; a power of two.
  uint32_t slots() const { return static_cast<uint32_t>(table.bytes / sizeof(gpu::GaussianCell)); }
};

/// What the voxels of a map gather of their points, beside count and mean.
enum class VoxelContent {
  surfaces,  ///< the surface constraints: for VGICP and, finished, point to plane
  moments,   ///< the second moments of positions: finished, for NDT
};

/// What record_finish() makes of a map.
struct FinishSettings {
  uint32_t min_points = 1;   ///< voxels with fewer points are left out
  double least_ratio = 0.0;  ///< for moments: eigenvalues are raised to this part of the largest
  double least_sigma = 0.0;  ///< and to the square of this, m
};

/// Fills Gaussian voxel maps. Counts, means and constraints are exact integer sums, so that the map
/// does not depend on the order of points or clouds, and a cloud can be taken out without a trace.
class VoxelMapKernels {
 public:
  explicit VoxelMapKernels(Context& context, VoxelContent content = VoxelContent::surfaces);

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
  /// Writes to `finished`, as long as the map's table, what NDT (of moments: Gaussians, their flat
  /// directions widened) and point to plane (of surfaces: planes) read: gpu::kGaussians,
  /// gpu::kPlanes. Needs a barrier before and after.
  void record_finish(Recorder& recorder, const VoxelMapView& map, const FinishSettings& settings,
                     Slice finished) const;

 private:
  void record(Recorder& recorder, const VoxelMapView& map, Slice surface_cloud, uint32_t count,
              const gpu::mat3x4& T_map_cloud, uint32_t sign) const;

  LaunchShape shape_;
  bool texels_;
  Kernel add_;
  Kernel finish_;
};

}  // namespace adit::engine
