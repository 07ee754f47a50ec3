// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/evaluate.hpp"
#include "adit/slam/core/units.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include <fmt/core.h>
#include <Eigen/Eigenvalues>

namespace adit {
namespace {

/// What is odd about the stamps of one side, "estimate" or "truth".
void warn_of_stamps(const std::string& side, const StampQuality& stamps, std::size_t poses,
                    std::vector<std::string>& warnings) {
  if (stamps.repeated == 0) {
    return;
  }
  const std::string what = fmt::format("{} of the {}'s {} poses have the time of the pose before",
                                       stamps.repeated, side, poses);
  if (stamps.conflicting == 0) {
    warnings.push_back(what + " and are the same poses: each of them counts");
    return;
  }
  warnings.push_back(
      fmt::format("{}, and {} of these are other poses, up to {:.3f} m away: {}; write one pose "
                  "a time",
                  what, stamps.conflicting, stamps.farthest,
                  side == "truth" ? "the first of each time is compared" : "each of them counts"));
}

/// The side whose times were written to more than the tolerance allows, while the other's are
/// finer; null: none. A sensor may really measure at such times, so this alone is no fault.
struct CoarseSide {
  std::string side;
  const StampQuality* stamps = nullptr;
};
CoarseSide coarse_side(const AssociationSummary& association, double tolerance) {
  const StampQuality& estimate = association.estimate_stamps;
  const StampQuality& truth = association.truth_stamps;
  const auto coarse = [&](const StampQuality& one, const StampQuality& other) {
    return seconds(one.step) > 2.0 * tolerance && one.step > other.step;
  };
  return coarse(estimate, truth)   ? CoarseSide{"estimate", &estimate}
         : coarse(truth, estimate) ? CoarseSide{"truth", &truth}
                                   : CoarseSide{};
}

std::string rounding_text(const CoarseSide& coarse) {
  return fmt::format(
      "the {}'s times were written to {:g} s only; write them with all digits "
      "(\"%.9f\" instead of \"%g\")",
      coarse.side, seconds(coarse.stamps->step));
}

/// Pairs that are not one to one, beyond the repeated times that were reported.
void warn_of_shared(const AssociationSummary& association, std::vector<std::string>& warnings) {
  const auto warn = [&](std::size_t shared, std::size_t repeated, const char* whose) {
    if (shared > repeated) {
      warnings.push_back(fmt::format(
          "{} of {} pairs share their pose of the {} with another pair, so the pairs are not one "
          "to one: the errors include the motion between; a smaller --tolerance drops such pairs",
          shared, association.pairs, whose));
    }
  };
  warn(association.shared_truth, association.estimate_stamps.repeated, "truth");
  warn(association.shared_estimate, association.truth_stamps.repeated, "estimate");
}

std::vector<std::string> find_warnings(const Trajectory& estimate, const Trajectory& truth,
                                       const AssociationSummary& association, double tolerance) {
  std::vector<std::string> warnings;
  if (!association.by_time && association.estimate_poses != association.truth_poses) {
    const bool one_stamped = estimate.stamped != truth.stamped;
    warnings.push_back(
        "the files hold " + std::to_string(association.estimate_poses) + " and " +
        std::to_string(association.truth_poses) +
        " poses and are matched by index: right only if both begin at the same sweep and none is "
        "left out" +
        (one_stamped ? "; give times to the one without (--truth-times, --estimate-times)" : ""));
  }
  const std::size_t possible = std::min(association.estimate_poses, association.truth_poses);
  const CoarseSide coarse =
      association.by_time ? coarse_side(association, tolerance) : CoarseSide{};
  const bool few = association.by_time && association.pairs * 10 < possible * 9;
  if (few) {
    warnings.push_back(
        "only " + std::to_string(association.pairs) + " of " + std::to_string(possible) +
        " possible pairs lie within the tolerance: the figures stand for these alone" +
        (coarse.stamps != nullptr ? "; " + rounding_text(coarse) : ""));
  }
  if (association.by_time) {
    const StampQuality& of_estimate = association.estimate_stamps;
    const StampQuality& of_truth = association.truth_stamps;
    warn_of_stamps("estimate", of_estimate, association.estimate_poses, warnings);
    warn_of_stamps("truth", of_truth, association.truth_poses, warnings);
    if (!few && coarse.stamps != nullptr && coarse.stamps->repeated > 0) {
      warnings.push_back(rounding_text(coarse) + "; the errors include the motion in that time");
    }
    warn_of_shared(association, warnings);
  }
  return warnings;
}

/// Standard deviations of the positions along their principal axes, m, smallest first.
Eigen::Vector3d spread_of(const std::vector<Eigen::Isometry3d>& poses) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Isometry3d& pose : poses) {
    mean += pose.translation() / static_cast<double>(poses.size());
  }
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Isometry3d& pose : poses) {
    const Eigen::Vector3d off = pose.translation() - mean;
    scatter += off * off.transpose() / static_cast<double>(poses.size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
}

/// On a nearly straight path, aligned by positions, errors of these turn the estimate about it.
std::optional<std::string> find_free_rotation(const Evaluation& evaluation) {
  constexpr double kStraight = 0.1;     // share of the length, across it
  constexpr double kHarmless = 0.0087;  // rad, half a degree
  const Alignment alignment = evaluation.options.alignment;
  const Eigen::Vector3d spread = spread_of(evaluation.truth);
  const double turn = std::atan2(evaluation.ate.rmse, spread[1]);
  if ((alignment != Alignment::se3 && alignment != Alignment::sim3) ||
      spread[1] > kStraight * spread[2] || turn < kHarmless) {
    return std::nullopt;
  }
  return fmt::format(
      "the path is nearly straight ({:.2f} m rms off a line, {:.1f} m along it) and aligned by "
      "positions alone, which tell how the estimate is turned about that line to some {:.1f} "
      "degrees only: the rotation of the ATE says little; that of the RPE does, or --align origin",
      spread[1], spread[2], turn * kDegreesPerRadian);
}

/// How the parts of one estimate lie to each other is a guess: one of them alone is compared.
Trajectory chosen_part(const Trajectory& estimate, std::size_t part) {
  if (part < 1 || part > estimate.parts.size() + 1) {
    throw InputError(estimate.file, {},
                     "it has no part " + std::to_string(part) + ", but " +
                         std::to_string(estimate.parts.size() + 1),
                     "Parts are counted from 1");
  }
  return part_of(estimate, part);
}

}  // namespace

Evaluation evaluate(const Trajectory& estimate, const Trajectory& truth,
                    const EvaluationOptions& options) {
  if (options.part) {
    EvaluationOptions rest = options;
    rest.part.reset();
    return evaluate(chosen_part(estimate, *options.part), truth, rest);
  }
  if (!estimate.parts.empty() && !options.across_parts && options.alignment != Alignment::none) {
    throw InputError(estimate.file, {},
                     "it has " + std::to_string(estimate.parts.size() + 1) +
                         " parts: the odometry started anew, and nothing ties one to the next",
                     "Choose one with --part N (from 1 on), or --align none");
  }
  Evaluation result;
  result.options = options;
  const Association association = associate(estimate, truth, options.tolerance);
  result.association = association.summary;
  std::vector<Eigen::Isometry3d> unaligned;
  unaligned.reserve(association.pairs.size());
  for (const MatchedPair& pair : association.pairs) {
    unaligned.push_back(estimate.poses[pair.estimate].pose);
    result.truth.push_back(truth.poses[pair.truth].pose);
    if (association.summary.by_time) {
      result.stamps.push_back(seconds(truth.poses[pair.truth].stamp));
    }
  }
  const std::optional<Similarity> alignment = align(unaligned, result.truth, options.alignment);
  if (!alignment) {
    throw InputError(estimate.file, {},
                     "its " + std::to_string(unaligned.size()) +
                         " matched positions do not determine an alignment: fewer than three, or "
                         "all on one line or in one place",
                     "Use --align origin or --align none");
  }
  result.alignment = *alignment;
  result.estimate.reserve(unaligned.size());
  for (const Eigen::Isometry3d& pose : unaligned) {
    result.estimate.push_back(*alignment * pose);
  }
  result.truth_path = path_lengths(result.truth);
  result.position_errors = position_errors(result.estimate, result.truth);
  result.ate = statistics(result.position_errors);
  result.ate_rotation = statistics(rotation_errors(result.estimate, result.truth));
  result.ate_unaligned = statistics(position_errors(unaligned, result.truth));
  result.rpe = relative_errors(result.estimate, result.truth, options.rpe);
  result.segments = kitti_segment_errors(result.estimate, result.truth);
  result.all_segments = result.segments.back();
  result.segments.pop_back();
  result.warnings = find_warnings(estimate, truth, result.association, options.tolerance);
  if (const auto free = find_free_rotation(result)) {
    result.rotation_determined = false;
    result.warnings.push_back(*free);
  }
  return result;
}

}  // namespace adit
