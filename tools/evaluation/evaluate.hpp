// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How far an estimated trajectory is from the truth. The steps in order, each usable alone:
// associate (evaluate_association.hpp), align (evaluate_alignment.hpp), measure
// (evaluate_metrics.hpp).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "adit/tools/evaluation/evaluate_alignment.hpp"
#include "adit/tools/evaluation/evaluate_association.hpp"
#include "adit/tools/evaluation/evaluate_metrics.hpp"
#include "adit/tools/results/trajectory_io.hpp"

namespace adit {

struct EvaluationOptions {
  Alignment alignment = Alignment::se3;
  double tolerance = 0.01;  ///< s, largest time difference of a matched pair
  RpeOptions rpe;
  /// Of an estimate whose odometry started anew, counted from 1; none: a common alignment of the
  /// parts is refused.
  std::optional<std::size_t> part{};
  bool across_parts = false;  ///< the parts count as one all the same
};

/// Everything `adit evaluate` reports. Poses are the matched ones: estimate[i] belongs to truth[i].
struct Evaluation {
  EvaluationOptions options;
  AssociationSummary association;
  Similarity alignment;  ///< truth <- estimate
  std::vector<Eigen::Isometry3d> truth;
  std::vector<Eigen::Isometry3d> estimate;  ///< aligned
  std::vector<double> stamps;           ///< s of the truth's poses; empty where matched by index
  std::vector<double> truth_path;       ///< m along the truth, one a pair
  std::vector<double> position_errors;  ///< m, after alignment, one a pair
  Statistics ate;                       ///< m, after alignment
  Statistics ate_rotation;              ///< deg, after alignment
  /// False where the path is so straight that its positions do not tell how the estimate is turned
  /// about it: then ate_rotation says little.
  bool rotation_determined = true;
  Statistics ate_unaligned;  ///< m
  RelativeErrors rpe;
  std::vector<SegmentErrors> segments;  ///< KITTI, one a length that fits into the truth
  SegmentErrors all_segments;           ///< KITTI, mean over all; count 0 where none fits
  std::vector<std::string> warnings;    ///< for people
};

/// Compares two trajectories. Throws InputError where nothing matches, the alignment is not
/// determined, or the estimate has several parts.
Evaluation evaluate(const Trajectory& estimate, const Trajectory& truth,
                    const EvaluationOptions& options);

}  // namespace adit
