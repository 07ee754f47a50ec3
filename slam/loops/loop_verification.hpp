// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Whether two submaps are of the same place, by aligning them (docs/theory/loops.md).
#pragma once

#include <span>
#include <vector>

#include "adit/slam/loops/loop_reason.hpp"
#include "adit/slam/registration/batch_aligner.hpp"
#include "adit/slam/submaps/keyframe_submap.hpp"

namespace adit {

/// Chi squared of 6 directions: 99 % of true loops are within.
inline constexpr double kExpectedGate = 16.81;

struct LoopVerificationSettings {
  double least_overlap = 0.4;
  double most_rms = 2.0;       ///< times that of alignments of consecutive submaps
  double most_through = 0.05;  ///< share of points that the other submap sees through
  double strong_overlap = 0.7;
};

/// A place to be verified.
struct LoopQuestion {
  const KeyframeSubmap* from = nullptr;  ///< the earlier submap, from the store
  Eigen::Isometry3d T_from_to = Eigen::Isometry3d::Identity();  ///< as the graph has it
  Matrix6d covariance = Matrix6d::Identity();                   ///< its own, right perturbation
  /// Refused is what is found beyond it; it may be wider than the gate that marks what is expected,
  /// as poses drift by more than their covariances say.
  double gate = kExpectedGate;
};

struct LoopVerification {
  LoopReason reason = LoopReason::none;  ///< none: it is validated
  double figure = 0.0;                   ///< the reason's figure
  Eigen::Isometry3d T_from_to = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Identity();
  double overlap = 0.0;
  double rms = 0.0;         ///< m
  double correction = 0.0;  ///< m, of the graph's pose
  double turn = 0.0;        ///< rad
  double chi2 = 0.0;        ///< chi squared of the correction, both covariances
  double through = 0.0;     ///< share of points seen through, the larger of both
  bool strong = false;      ///< much overlap, every direction fully held
  bool expected = false;    ///< within kExpectedGate
};

/// Verifies the places of one keyframe in a batch.
class LoopVerifier {
 public:
  LoopVerifier(engine::Context& context, const Config& config,
               const LoopVerificationSettings& settings = {});

  /// A result per question, in order. `cloud` is `to` on the device; `expected_rms` (m) that of
  /// alignments of consecutive submaps. Throws engine::OutOfMemory.
  std::vector<LoopVerification> verify(const KeyframeSubmap& to, const SurfaceCloud& cloud,
                                       std::span<const LoopQuestion> questions,
                                       double expected_rms);

 private:
  engine::Context* context_;
  LoopVerificationSettings settings_;
  double r_align_;
  AlignmentClouds clouds_;
  BatchAligner aligner_;
};

}  // namespace adit
