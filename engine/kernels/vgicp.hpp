// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "engine/buffer.hpp"
#include "engine/kernel.hpp"
#include "engine/kernels/launch.hpp"
#include "engine/kernels/voxel_map.hpp"
#include "engine/recorder.hpp"
#include "shaders/shared/registration.h"

namespace adit::engine {

/// Settings of one level of an alignment; lengths in m, the angle in rad.
struct VgicpSettings {
  double d_max = 0.0;
  double translation_epsilon = 0.0;
  double rotation_epsilon = 0.0;
  uint32_t max_iterations = 0;
};

/// Slices of one alignment.
struct VgicpArguments {
  Slice surface_cloud;  ///< in: the source
  Slice counters;       ///< in: gpu::SweepCounters of the source, for its number of points
  VoxelMapView target;
  Slice start;  ///< in: gpu::RegistrationStart from Vgicp::start()
  Slice state;  ///< in and out: gpu::RegistrationState; its pose is the initial guess, then the
                ///< result
};

/// Voxelised GICP (Koide et al., ICRA 2021), Gauss-Newton, with the iterations, the 6x6 solves and
/// the test of convergence on the device: nothing is waited for, and what is recorded beyond
/// convergence costs nothing.
class Vgicp {
 public:
  explicit Vgicp(Context& context);

  uint64_t scratch_bytes() const;
  /// What VgicpArguments::start holds.
  gpu::RegistrationStart start() const;
  /// Up to max_iterations steps and one evaluation at the final pose. Levels of a coarse-to-fine
  /// alignment are recorded one after the other on the same state. Begins with a barrier and ends
  /// with one.
  void record(Recorder& recorder, const VgicpSettings& settings, const VgicpArguments& arguments,
              Slice scratch) const;

 private:
  LaunchShape shape_;
  bool texels_;
  Kernel linearize_;
};

}  // namespace adit::engine
