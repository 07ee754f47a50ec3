// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "adit/engine/buffer.hpp"
#include "adit/engine/kernels/registration.hpp"
#include "adit/slam/core/config.hpp"
#include "adit/slam/odometry/motion_model.hpp"
#include "adit/slam/odometry/submap.hpp"
#include "adit/slam/registration/alignment_clouds.hpp"
#include "adit/slam/registration/registration.hpp"

namespace adit {

/// Aligns a sweep's cloud with the submap on the device: VGICP or NDT from the predicted pose, and
/// from each of the places to search from coarse voxels down to fine ones: the best one counts, and
/// tells how well the best other place fits.
class Aligner {
 public:
  Aligner(engine::Context& context, const RegistrationConfig& config);

  /// Other lengths, before the first alignment; the method stays.
  void use_lengths(const RegistrationConfig& config) { config_ = config; }

  /// Records the alignment and the copies back; the submap is up to date and not empty.
  /// `places` (T_map_lidar, kMostPlaces at most; none: no search) are searched from. The device
  /// knows how many points the cloud has; at most `most_points`.
  void record(engine::Recorder& recorder, const Prediction& prediction,
              std::span<const Eigen::Isometry3d> places, engine::Slice surface_cloud,
              engine::Slice counters, uint32_t most_points, Submap& submap);
  /// After the submission: the alignment needs more steps than were recorded. Usually it does not:
  /// as many are recorded as the last ones needed and one more, since each step beyond the last has
  /// its price on a GPU, although it does nothing.
  bool unfinished() const;
  /// Records the steps that follow, and the copies back; what record() was given is still there.
  void record_rest(engine::Recorder& recorder, engine::Slice surface_cloud, const Submap& submap);
  /// After that: the result in the map frame, and what the submap's voxel map counted.
  RegistrationResult read_result(int source_points, const Submap& submap);
  gpu::VoxelMapCounters read_map_counters() const;

 private:
  /// A level of the alignment from the prediction, or of the search from all its starts.
  engine::RegistrationArguments arguments(bool search, size_t level, engine::Slice surface_cloud,
                                          const engine::VoxelMapView& target) const;
  void record_starts(engine::Recorder& recorder, const Prediction& prediction,
                     std::span<const Eigen::Isometry3d> places, const Submap& submap);
  void record_search(engine::Recorder& recorder, engine::Slice surface_cloud,
                     engine::Slice counters, Submap& submap);
  /// Passes of the fine alignment that are recorded at once.
  struct Passes {
    uint32_t steps = 0;
    uint32_t constrained_steps = 0;
  };
  engine::RegistrationSettings settings(bool trusted) const;
  Passes most_passes(const engine::RegistrationSettings& settings) const;
  /// What the last alignments needed. A trusted prediction decides in directions that no match
  /// holds.
  Passes expected_passes(const engine::RegistrationSettings& settings) const;
  void record_fine(engine::Recorder& recorder, const engine::RegistrationArguments& arguments,
                   const engine::RegistrationSettings& settings, const Passes& passes);
  void record_readback(engine::Recorder& recorder, const Submap& submap);
  const gpu::RegistrationHeader& header() const;
  void note_passes(const RegistrationResult& result);
  void record_jobs(engine::Recorder& recorder, size_t level, const engine::VoxelMapView& target,
                   double d_max, engine::Slice counters);

  RegistrationConfig config_;
  RegistrationMethod method_;
  engine::RegistrationKernels kernels_;
  engine::Buffer upload_;    ///< jobs of all levels, starts, initial states
  engine::Buffer jobs_;      ///< all levels, with the number of points that the device knows
  engine::Buffer progress_;  ///< alignment from the prediction, then the search
  engine::Buffer states_;    ///< the same
  engine::Buffer scratch_;
  engine::Buffer readback_;         ///< states, progress, then the voxel map's counters
  uint32_t groups_ = 0;             ///< number in the last alignment recorded
  uint32_t starts_ = 0;             ///< that its search had; 0: there was none
  bool trusted_ = false;            ///< its prediction
  bool weighed_ = false;            ///< against the matches, in every step
  Passes recorded_;                 ///< of the last alignment, so far
  std::array<uint32_t, 8> steps_;   ///< of the last alignments, in turns
  size_t next_ = 0;                 ///< in steps_
  uint32_t constrained_steps_ = 0;  ///< of the last alignment
};

}  // namespace adit
