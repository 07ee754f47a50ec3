// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "adit/engine/buffer.hpp"
#include "adit/engine/kernels/registration.hpp"
#include "adit/slam/core/checkpoint.hpp"
#include "adit/slam/core/config.hpp"
#include "adit/slam/registration/alignment_clouds.hpp"
#include "adit/slam/registration/registration.hpp"

namespace adit {

/// Less weight for matches far apart, in units of their own uncertainty.
enum class RobustKernel { none, huber, cauchy, geman_mcclure };

/// How the pairs of a batch are aligned; lengths in m, angles in rad.
struct AlignmentSettings {
  RegistrationMethod method = RegistrationMethod::vgicp;
  int neighbours = 7;  ///< voxels looked at for a point: 1, 7 (those that share a face) or 27
  RobustKernel robust = RobustKernel::none;
  double robust_width = 1.0;     ///< Mahalanobis distance at which it begins to act
  bool drop_back_faces = false;  ///< leave out surfaces that the target's sensor could only have
                                 ///< seen from behind
  double d_max = 0.5;            ///< at the finest level; voxel size where that is larger
  double d_max_wide = 0.0;       ///< instead, in the first wide_iterations; less than d_max: unused
  int wide_iterations = 0;
  int max_iterations = 30;            ///< limit for each level
  double translation_epsilon = 1e-4;  ///< converged when a step is shorter, and turns less than
  double rotation_epsilon = 1e-5;
  bool resolve_weak = true;  ///< where directions are weak, solve again with the prior
  int min_inliers = 100;
  double min_overlap = 0.3;
};

/// One alignment. Clouds and targets must live until align() returns.
struct AlignmentPair {
  const SurfaceCloud* source = nullptr;
  const AlignmentTarget* source_map = nullptr;  ///< its Gaussians, for ndt_to_ndt alone
  const AlignmentTarget* target = nullptr;
  Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();  ///< initial guess
  /// Prior whose mean is the guess, right perturbation. Decides in weak directions.
  Matrix6d prior_information = Matrix6d::Zero();
};

class BatchAligner;

/// A batch under way. It is worked off in pieces, each a submission of its own, so that other work
/// on the device, a live sweep's above all, waits for one piece at most. The aligner, the clouds
/// and the targets must outlive it.
class BatchAlignment {
 public:
  BatchAlignment(BatchAlignment&&) noexcept;
  BatchAlignment& operator=(BatchAlignment&&) noexcept;
  ~BatchAlignment();

  /// Nothing is left to submit or to wait for.
  bool done() const;
  /// Submits the next piece and does not wait: what the device is expected to do in `budget` ms, by
  /// what it did so far, and one pass over one pair at least. Waits for the piece before it, if
  /// nobody has. Throws engine::OutOfMemory, engine::DeviceLost.
  void submit(double budget);
  /// Waits for the piece that was submitted last.
  void wait();
  /// Works off what is left, in one piece, or in pieces with a checkpoint before each. Results in
  /// the order of the pairs.
  std::vector<RegistrationResult> finish(const Checkpoint& checkpoint = {});

 private:
  friend class BatchAligner;
  struct State;
  explicit BatchAlignment(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Aligns any number of pairs at once: one submission and one wait for as many as fit the device.
/// A pair's result does not depend on the others of its batch, nor on how it was cut into pieces,
/// bit for bit.
class BatchAligner {
 public:
  BatchAligner(engine::Context& context, const AlignmentSettings& settings);

  const AlignmentSettings& settings() const { return settings_; }
  /// Results in the order of the pairs. A pair that cannot be aligned (no points, a guess that is
  /// not finite) has a status that says so. Throws std::logic_error for a target of another method
  /// or with other numbers of levels than the rest, engine::OutOfMemory; the next call works.
  std::vector<RegistrationResult> align(std::span<const AlignmentPair> pairs,
                                        const Checkpoint& checkpoint = {}) const;
  /// The same, without a step: how well the guesses fit.
  std::vector<RegistrationResult> evaluate(std::span<const AlignmentPair> pairs,
                                           const Checkpoint& checkpoint = {}) const;
  /// The same as align(), to be worked off in pieces.
  BatchAlignment begin(std::span<const AlignmentPair> pairs) const;

 private:
  BatchAlignment start(std::span<const AlignmentPair> pairs, bool steps) const;

  engine::Context* context_;
  AlignmentSettings settings_;
  engine::RegistrationKernels kernels_;
};

}  // namespace adit
