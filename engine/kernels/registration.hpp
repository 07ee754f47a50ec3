// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "adit/engine/buffer.hpp"
#include "adit/engine/kernel.hpp"
#include "adit/engine/kernels/launch.hpp"
#include "adit/engine/recorder.hpp"
#include "adit/shaders/shared/registration.h"

namespace adit::engine {

/// Which alignment the kernels are specialised for.
struct RegistrationOptions {
  uint32_t method = gpu::kVgicp;     ///< gpu::kVgicp, kNdt, kPointToPlane or kNdtToNdt
  uint32_t neighbours = 1;           ///< voxels looked at for a point: 1, 7 or 27
  uint32_t robust = gpu::kNoRobust;  ///< gpu::kNoRobust, kHuber, kCauchy or kGemanMcClure
  bool many = false;  ///< of them are aligned at once (launch.hpp); the same sums in another order
  bool drop_back_faces = false;  ///< leave out surfaces that the target's sensor could only
                                 ///< have seen from behind
};

/// Settings of one level of a batch; length in m, angle in rad.
struct RegistrationSettings {
  double translation_epsilon = 0.0;
  double rotation_epsilon = 0.0;
  uint32_t max_iterations = 0;
  uint32_t max_constrained = 0;  ///< steps without weak directions; 0: these are only reported
  double weak_share = 1.0;       ///< directions that keep less of their information call for these
                                 ///< steps, and those that keep none
  double robust_width = 1.0;     ///< Mahalanobis distance at which the robust kernel begins to act
};

/// Slices of a batch of `count` alignments.
struct RegistrationArguments {
  uint32_t count = 0;
  uint32_t group_stride = 0;  ///< the largest RegistrationJob::groups
  Slice source;    ///< in: surface clouds (Preprocess), or voxel tables for gpu::kNdtToNdt
  Slice target;    ///< in: voxel tables (VoxelMapKernels)
  Slice jobs;      ///< in: gpu::RegistrationJob each
  Slice start;     ///< in: what RegistrationKernels::write_start() wrote
  Slice progress;  ///< in and out: progress_bytes()
  Slice states;    ///< in and out: gpu::RegistrationState each; pose and guess hold the initial
                   ///< guess, then pose holds the result
};

/// Alignments of clouds with voxel maps by Gauss-Newton: voxelised GICP (Koide et al., ICRA 2021),
/// P2D and D2D NDT (Magnusson 2009; Stoyanov et al., IJRR 2012) and point to plane. The iterations,
/// the 6x6 solves, the test of convergence and the treatment of directions that the matches do not
/// hold are on the device: nothing is waited for, and what is recorded beyond convergence costs
/// nothing. All alignments of a batch share every dispatch.
class RegistrationKernels {
 public:
  RegistrationKernels(Context& context, const RegistrationOptions& options);

  const RegistrationOptions& options() const { return options_; }
  /// Groups for a source of so many points, or, where only the device knows how many, of at most so
  /// many: its sums do not depend on the rest of the batch.
  uint32_t groups(uint32_t points) const;

  static uint64_t progress_bytes(uint32_t count);
  uint64_t scratch_bytes(uint32_t count, uint32_t group_stride) const;
  /// Fills what RegistrationArguments::start refers to, progress_bytes() long. `phase` is
  /// gpu::kPhaseIterate, or gpu::kPhaseAssess to have the given poses assessed as they are.
  static void write_start(std::span<std::byte> bytes, uint32_t count, uint32_t group_stride,
                          uint32_t phase = gpu::kPhaseIterate);

  /// The passes of one level, in this order. A long alignment may be cut between any two of them
  /// into several submissions: all that goes on from one to the next is in the batch's own slices.
  enum class Stage {
    iterate,    ///< steps, up to RegistrationSettings::max_iterations
    geometry,   ///< the sums at each pose, and which directions its matches hold: 2 passes
    constrain,  ///< steps without the weak directions and with the prior, up to max_constrained
    geometry_again,  ///< as geometry, where there were such steps: 2 passes
  };
  /// How many passes a stage has at most. What is recorded beyond convergence does nothing.
  uint32_t passes(Stage stage, const RegistrationSettings& settings) const;
  /// Where the header of RegistrationArguments::progress tells the work left in a stage.
  static uint64_t remaining_at(Stage stage);

  /// Starts every alignment of the batch. Begins and ends with a barrier.
  static void record_start(Recorder& recorder, const RegistrationArguments& arguments);
  /// `count` passes of a stage from its pass number `first` on. Ends with a barrier.
  void record(Recorder& recorder, Stage stage, uint32_t first, uint32_t count,
              const RegistrationSettings& settings, const RegistrationArguments& arguments,
              Slice scratch) const;

  /// Starts every alignment of the batch and takes up to max_iterations steps. Levels of a
  /// coarse-to-fine alignment are recorded one after the other on the same states. Begins and ends
  /// with a barrier.
  void record_steps(Recorder& recorder, const RegistrationSettings& settings,
                    const RegistrationArguments& arguments, Slice scratch) const;
  /// After the last level: the sums at each pose and, for sources with surfaces, which directions
  /// its matches hold; where some are weak, the alignment goes on with these taken out and the
  /// prior added. Ends with a barrier.
  void record_assessment(Recorder& recorder, const RegistrationSettings& settings,
                         const RegistrationArguments& arguments, Slice scratch) const;

 private:
  void record_pass(Recorder& recorder, const Kernel& kernel, uint32_t phase, uint64_t pass_at,
                   const RegistrationSettings& settings, const RegistrationArguments& arguments,
                   Slice scratch) const;

  RegistrationOptions options_;
  LaunchShape shape_;
  bool texels_;
  Kernel linearize_;
  Kernel assess_;
  Kernel localize_;
};

}  // namespace adit::engine
