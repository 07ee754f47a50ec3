// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/loops/loop_verification.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include <Eigen/Eigenvalues>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/registration/competing_poses.hpp"
#include "adit/slam/submaps/free_space.hpp"
#include "adit/slam/submaps/submap_alignment.hpp"

namespace adit {
namespace {

// That of consecutive submaps (keyframe_edge.cpp), but places are seen from elsewhere, and what
// both alignments of a bundle have in common is not known (docs/theory/loops.md).
constexpr CovarianceModel kLoopModel{
    .kappa = 0.3, .area = 0.016, .sigma_translation = 0.03, .sigma_rotation = 0.003};

// Along the direction that is held least, other poses are looked for so far, m.
constexpr double kLeastReach = 2.0;
constexpr double kMostReach = 6.0;

/// As far as the prior lets the pose be: three standard deviations in its least known direction.
double competing_reach(const Matrix6d& prior) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(prior.topLeftCorner<3, 3>(),
                                                             Eigen::EigenvaluesOnly);
  return std::clamp(3.0 * std::sqrt(std::max(eigen.eigenvalues()(2), 0.0)), kLeastReach,
                    kMostReach);
}

const ObservedDirection& weakest(const RegistrationResult& result) {
  return result.rotation.front().localizability == Localizability::none &&
                 result.translation.front().localizability != Localizability::none
             ? result.rotation.front()
             : result.translation.front();
}

bool all_held(const RegistrationResult& result) {
  const auto full = [](const ObservedDirection& direction) {
    return direction.localizability == Localizability::full;
  };
  return result.status == RegistrationStatus::converged &&
         std::ranges::all_of(result.translation, full) &&
         std::ranges::all_of(result.rotation, full);
}

void refuse(LoopVerification& verdict, LoopReason reason, double figure) {
  verdict.reason = reason;
  verdict.figure = figure;
}

LoopVerification judged(const LoopQuestion& question, const RegistrationResult& result,
                        const LoopVerificationSettings& settings, double most_rms) {
  LoopVerification verdict{
      .T_from_to = result.T_target_source, .overlap = result.overlap, .rms = result.residual_rms};
  if (!is_usable(result.status)) {
    verdict.T_from_to = question.T_from_to;
    const bool little = result.status == RegistrationStatus::too_little_overlap ||
                        result.status == RegistrationStatus::too_few_points;
    refuse(verdict, little ? LoopReason::too_little_overlap : LoopReason::not_aligned,
           result.overlap);
    return verdict;
  }
  verdict.covariance = covariance(result, kLoopModel);
  const Vector6d off = se3_log(question.T_from_to.inverse() * result.T_target_source);
  verdict.correction = (question.T_from_to.inverse() * result.T_target_source).translation().norm();
  verdict.turn = off.tail<3>().norm();
  const Matrix6d both = question.covariance + verdict.covariance;
  verdict.chi2 = off.dot(both.ldlt().solve(off));
  verdict.expected = verdict.chi2 <= kExpectedGate;
  verdict.strong = result.overlap >= settings.strong_overlap && all_held(result);
  if (result.overlap < settings.least_overlap) {
    refuse(verdict, LoopReason::too_little_overlap, result.overlap);
  } else if (result.residual_rms > most_rms) {
    refuse(verdict, LoopReason::poor_fit, result.residual_rms);
  } else if (result.status == RegistrationStatus::degenerate) {
    refuse(verdict, LoopReason::degenerate, weakest(result).information);
  } else if (!(verdict.chi2 <= question.gate)) {
    refuse(verdict, LoopReason::beyond_gate, verdict.chi2);
  }
  return verdict;
}

}  // namespace

std::string_view to_string(LoopReason reason) {
  switch (reason) {
    case LoopReason::none:
      return "none";
    case LoopReason::not_aligned:
      return "not_aligned";
    case LoopReason::too_little_overlap:
      return "too_little_overlap";
    case LoopReason::poor_fit:
      return "poor_fit";
    case LoopReason::degenerate:
      return "degenerate";
    case LoopReason::beyond_gate:
      return "beyond_gate";
    case LoopReason::ambiguous:
      return "ambiguous";
    case LoopReason::seen_through:
      return "seen_through";
    case LoopReason::against_odometry:
      return "against_odometry";
    case LoopReason::against_loops:
      return "against_loops";
    case LoopReason::another_place:
      return "another_place";
    case LoopReason::few_votes:
      return "few_votes";
    case LoopReason::review:
      return "review";
    case LoopReason::by_hand:
      return "by_hand";
    case LoopReason::added_by_hand:
      return "added_by_hand";
  }
  return "unknown";
}

LoopVerifier::LoopVerifier(engine::Context& context, const Config& config,
                           const LoopVerificationSettings& settings)
    : context_(&context),
      settings_(settings),
      r_align_(config.registration.r_align),
      clouds_(context, config.preprocess),
      aligner_(context, submap_alignment_settings(config, RegistrationMethod::vgicp)) {}

std::vector<LoopVerification> LoopVerifier::verify(const KeyframeSubmap& to,
                                                   const SurfaceCloud& cloud,
                                                   std::span<const LoopQuestion> questions,
                                                   double expected_rms) {
  std::vector<LoopVerification> verdicts(questions.size());
  std::vector<AlignmentTarget> targets;
  targets.reserve(questions.size());
  std::vector<AlignmentPair> pairs;
  std::vector<std::size_t> of;  // the question of each pair
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const LoopQuestion& question = questions[i];
    verdicts[i].T_from_to = question.T_from_to;
    if (question.from->points.empty() || cloud.size == 0) {
      refuse(verdicts[i], LoopReason::not_aligned, 0.0);
      continue;
    }
    const std::array sizes = {4.0 * r_align_, 2.0 * r_align_, r_align_};
    targets.push_back(clouds_.make_target(make_surface_cloud(*context_, *question.from),
                                          aligner_.settings().method, sizes));
    pairs.push_back({.source = &cloud,
                     .target = &targets.back(),
                     .T_target_source = question.T_from_to,
                     .prior_information = symmetric_inverse(question.covariance)});
    of.push_back(i);
  }
  const std::vector<RegistrationResult> results = aligner_.align(pairs);
  std::vector<AlignmentPair> open_pairs;
  std::vector<RegistrationResult> open_results;
  std::vector<std::size_t> open;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    LoopVerification& verdict = verdicts[of[k]];
    verdict = judged(questions[of[k]], results[k], settings_, settings_.most_rms * expected_rms);
    if (verdict.reason == LoopReason::none) {
      open_pairs.push_back(pairs[k]);
      open_results.push_back(results[k]);
      open.push_back(of[k]);
    }
  }
  if (open.empty()) {
    return verdicts;
  }
  const RangeImage image(to);
  for (std::size_t k = 0; k < open.size(); ++k) {
    LoopVerification& verdict = verdicts[open[k]];
    const KeyframeSubmap& from = *questions[open[k]].from;
    // On the finest level alone: coarse ones would lead every start back to the same pose.
    const AlignmentTarget fine = clouds_.make_target(
        make_surface_cloud(*context_, from), aligner_.settings().method, std::array{r_align_});
    open_pairs[k].target = &fine;
    const std::optional<CompetingPose> competing =
        find_competing_poses(aligner_, std::span(&open_pairs[k], 1), std::span(&open_results[k], 1),
                             {.reach = competing_reach(questions[open[k]].covariance),
                              .spacing = 0.5 * r_align_,
                              .least_apart = 0.5 * r_align_})
            .front();
    if (competing) {
      refuse(verdict, LoopReason::ambiguous, std::abs(competing->apart));
      continue;
    }
    verdict.through = std::max(seen_through(image, from, verdict.T_from_to.inverse()),
                               seen_through(RangeImage(from), to, verdict.T_from_to));
    if (verdict.through > settings_.most_through) {
      refuse(verdict, LoopReason::seen_through, verdict.through);
    }
  }
  return verdicts;
}

}  // namespace adit
