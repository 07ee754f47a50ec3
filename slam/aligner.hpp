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

/// Aligns a sweep's cloud with the submap on the device: VGICP from the predicted pose, and, where
/// the prediction is not to be trusted, a second time from coarse voxels down to fine ones: the
/// better one counts.
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
  void record_search(engine::Recorder& recorder, engine::VgicpArguments arguments, Submap& submap);
  void record_fine(engine::Recorder& recorder, const engine::VgicpArguments& arguments);

  RegistrationConfig config_;
  engine::Vgicp vgicp_;
  engine::Buffer upload_;  ///< start block, then the initial pose
  engine::Buffer states_;  ///< of the alignment from the prediction, then of the search
  engine::Buffer scratch_;
  engine::Buffer readback_;  ///< both states, then the voxel map's counters
  bool searched_ = false;    ///< the last alignment recorded has a second state
};

}  // namespace adit
