// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/registration/competing_poses.hpp"

#include <algorithm>
#include <stdexcept>

namespace adit {
namespace {

Eigen::Vector3d least_held(const RegistrationResult& result) {
  return result.translation.front().axis;
}

bool can_have_competing_poses(const RegistrationResult& result) {
  return is_usable(result.status) && least_held(result).norm() > 0.5;
}

AlignmentPair moved(const AlignmentPair& pair, const RegistrationResult& result, double along) {
  AlignmentPair copy = pair;
  copy.T_target_source = result.T_target_source * Eigen::Translation3d(along * least_held(result));
  copy.prior_information.setZero();
  return copy;
}

// The best local peak of the scores along one side (nearest first). The farthest offset where
// the fit only falls or stays as it is.
size_t most_promising(std::span<const RegistrationResult> along) {
  size_t best = along.size() - 1;
  bool found = false;
  for (size_t k = 1; k + 1 < along.size(); ++k) {
    const bool peak = fits_better(along[k], along[k - 1]) && !fits_better(along[k + 1], along[k]);
    if (peak && (!found || fits_better(along[k], along[best]))) {
      best = k;
      found = true;
    }
  }
  return best;
}

double apart(const RegistrationResult& competing, const RegistrationResult& result) {
  return (result.T_target_source.inverse() * competing.T_target_source)
      .translation()
      .dot(least_held(result));
}

}  // namespace

bool fits_better(const RegistrationResult& a, const RegistrationResult& b) {
  const double margin = 0.01 * std::max(a.overlap, b.overlap);
  return a.overlap > b.overlap + margin ||
         (a.overlap > b.overlap - margin && a.residual_rms < b.residual_rms);
}

std::vector<std::optional<CompetingPose>> find_competing_poses(
    BatchAligner& aligner, std::span<const AlignmentPair> pairs,
    std::span<const RegistrationResult> results, const CompetingPoseSettings& settings,
    const Checkpoint& checkpoint) {
  if (pairs.size() != results.size()) {
    throw std::logic_error("competing poses are looked for with one result a pair");
  }
  if (!(settings.spacing > 0.0) || settings.reach < settings.spacing) {
    throw std::logic_error("competing poses are looked for at offsets of `spacing` up to `reach`");
  }
  // For each result its offsets ahead, nearest first, then those behind.
  const auto count = static_cast<size_t>(settings.reach / settings.spacing);
  std::vector<AlignmentPair> offsets;
  std::vector<size_t> of;
  for (size_t i = 0; i < pairs.size(); ++i) {
    if (!can_have_competing_poses(results[i])) {
      continue;
    }
    for (const double sign : {1.0, -1.0}) {
      of.push_back(i);
      for (size_t k = 1; k <= count; ++k) {
        offsets.push_back(
            moved(pairs[i], results[i], sign * static_cast<double>(k) * settings.spacing));
      }
    }
  }
  const std::vector<RegistrationResult> scores = aligner.evaluate(offsets, checkpoint);
  std::vector<AlignmentPair> starts;
  for (size_t side = 0; side < of.size(); ++side) {
    const std::span<const RegistrationResult> along =
        std::span(scores).subspan(side * count, count);
    starts.push_back(offsets[side * count + most_promising(along)]);
  }
  const std::vector<RegistrationResult> found = aligner.align(starts, checkpoint);

  std::vector<std::optional<CompetingPose>> competing(pairs.size());
  for (size_t k = 0; k < found.size(); ++k) {
    const RegistrationResult& result = results[of[k]];
    const double distance = apart(found[k], result);
    const bool competes = is_usable(found[k].status) &&
                          std::abs(distance) >= settings.least_apart &&
                          found[k].overlap >= settings.least_overlap * result.overlap &&
                          found[k].residual_rms <= settings.most_rms * result.residual_rms;
    std::optional<CompetingPose>& best = competing[of[k]];
    if (competes && (!best || fits_better(found[k], best->result))) {
      best = CompetingPose{found[k], distance};
    }
  }
  return competing;
}

}  // namespace adit
