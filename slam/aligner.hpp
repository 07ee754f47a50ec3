// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/buffer.hpp"
#include "engine/kernels/vgicp.hpp"
#include "slam/config.hpp"
#include "slam/motion_model.hpp"
#include "slam/registration.hpp"
#include "slam/submap.hpp"

namespace adit {

/// Aligns a sweep's cloud with the submap on the device: VGICP from the predicted pose, or, where the
/// prediction is not to be trusted, from coarse voxels down to fine ones.
class Aligner {
 public:
  Aligner(engine::Context& context, const RegistrationConfig& config);

  /// Records the whole alignment and the copies back; the submap is up to date and not empty.
  void record(engine::Recorder& recorder, const Prediction& prediction, engine::Slice surface_cloud,
              engine::Slice counters, Submap& submap);
  /// After the submission: the result in the map frame, and what the submap's voxel map counted.
  RegistrationResult read_result(int source_points, const Submap& submap) const;
  gpu::VoxelMapCounters read_map_counters() const;

 private:
  RegistrationConfig config_;
  engine::Vgicp vgicp_;
  engine::Buffer upload_;    ///< start block, then the initial pose
  engine::Buffer state_;
  engine::Buffer scratch_;
  engine::Buffer readback_;  ///< state, then the voxel map's counters
};

}  // namespace adit
