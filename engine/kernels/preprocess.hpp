// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

#include "adit/engine/buffer.hpp"
#include "adit/engine/kernel.hpp"
#include "adit/engine/kernels/launch.hpp"
#include "adit/engine/recorder.hpp"
#include "adit/shaders/shared/preprocess.h"

namespace adit::engine {

/// Lengths in m, the angle in rad.
struct PreprocessSettings {
  double c_min = 0.0;
  double c_max = 0.0;
  double r_input = 0.0;
  double beam_spacing = 0.0;
  double surface_size = 0.0;

  /// Edge of the cells whose points give a surface near the sensor, m: wide enough for several
  /// neighbours.
  double surface_cell() const { return std::max(surface_size, 2.5 * r_input); }
  /// How much wider they must be, by range (1/m), to span the gap between beams: a factor of at
  /// least 1.
  double surface_growth() const { return 2.5 * beam_spacing / surface_cell(); }
};

/// Slices of one sweep. `capacity` is the number of points that scratch and outputs were sized for;
/// point_count <= capacity.
struct PreprocessArguments {
  uint32_t point_count = 0;
  uint32_t capacity = 0;
  Slice raw;    ///< in: vec4 (x, y, z, intensity) a point, sensor frame
  Slice cloud;  ///< out: vec4 (x, y, z, intensity) a point: one centroid a voxel, in sweep order
  Slice surface_cloud;  ///< out: uvec4 (bits of x, y, z, packed surface) a point
  Slice counters;       ///< in and out: gpu::SweepCounters
};

/// Drops invalid points, clips the range, down-samples to one centroid a voxel of r_input, and
/// estimates the surface (plane, line, isotropic) at each point. Same input, same bytes: all sums
/// are integers, and the output is in the order in which the sweep first entered each voxel
/// (docs/theory/preprocessing.md).
class Preprocess {
 public:
  explicit Preprocess(Context& context);

  /// Bytes of scratch for sweeps of up to `capacity` points.
  uint64_t scratch_bytes(uint32_t capacity) const;
  /// Must be recorded once for new scratch, and after a submission that failed.
  void record_reset(Recorder& recorder, Slice scratch) const;
  /// Four dispatches. Zeroes the counters first. Ends without a barrier.
  void record(Recorder& recorder, const PreprocessSettings& settings,
              const PreprocessArguments& arguments, Slice scratch) const;

 private:
  LaunchShape shape_;
  bool texels_;
  Kernel insert_;
  Kernel count_;
  Kernel emit_;
  Kernel normals_;
};

}  // namespace adit::engine
