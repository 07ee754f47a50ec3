// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/evaluate_association.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <set>
#include <string>

#include <fmt/core.h>

#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

using Seconds = std::chrono::duration<double>;

bool earlier(const StampedPose& pose, Nanoseconds stamp) {
  return pose.stamp < stamp;
}

/// Index of the pose nearest in time, the earlier one of two as near. `poses` is sorted by time.
std::size_t nearest(const std::vector<StampedPose>& poses, Nanoseconds stamp) {
  const auto after = std::lower_bound(poses.begin(), poses.end(), stamp, earlier);
  if (after == poses.begin()) {
    return 0;
  }
  const auto before = after - 1;
  const bool take_before = after == poses.end() || stamp - before->stamp <= after->stamp - stamp;
  return static_cast<std::size_t>((take_before ? before : after) - poses.begin());
}

double path_length(const std::vector<StampedPose>& poses, std::size_t from, std::size_t to) {
  double length = 0.0;
  for (std::size_t i = from + 1; i <= to; ++i) {
    length += (poses[i].pose.translation() - poses[i - 1].pose.translation()).norm();
  }
  return length;
}

std::string span_text(const Trajectory& trajectory) {
  const auto text = [](Nanoseconds stamp) { return std::to_string(Seconds(stamp).count()); };
  return text(trajectory.poses.front().stamp) + " to " + text(trajectory.poses.back().stamp) + " s";
}

std::vector<MatchedPair> associate_by_time(const Trajectory& estimate, const Trajectory& truth,
                                           double tolerance) {
  const bool estimate_is_longer = estimate.poses.size() > truth.poses.size();
  const Trajectory& shorter = estimate_is_longer ? truth : estimate;
  const Trajectory& longer = estimate_is_longer ? estimate : truth;
  std::vector<MatchedPair> pairs;
  for (std::size_t i = 0; i < shorter.poses.size(); ++i) {
    const std::size_t j = nearest(longer.poses, shorter.poses[i].stamp);
    const Nanoseconds difference = shorter.poses[i].stamp - longer.poses[j].stamp;
    if (Seconds(std::chrono::abs(difference)).count() > tolerance) {
      continue;
    }
    pairs.push_back(estimate_is_longer ? MatchedPair{j, i} : MatchedPair{i, j});
    for (std::size_t k = j + 1; estimate_is_longer && k < longer.poses.size() &&
                                longer.poses[k].stamp == longer.poses[j].stamp;
         ++k) {
      pairs.push_back({k, i});
    }
  }
  if (pairs.empty()) {
    throw InputError(estimate.file, {},
                     "none of its poses (" + span_text(estimate) + ") is within " +
                         std::to_string(tolerance) + " s of one of " + truth.file.string() + " (" +
                         span_text(truth) + ")",
                     "Check that both use the same clock, or give a larger --tolerance");
  }
  return pairs;
}

/// Throws InputError where rounding has taken most poses their own time.
void require_own_times(const Trajectory& trajectory, const StampQuality& stamps, double tolerance) {
  const std::size_t poses = trajectory.poses.size();
  if (2 * stamps.repeated <= poses || Seconds(stamps.step).count() <= tolerance) {
    return;
  }
  throw InputError(
      trajectory.file, {},
      fmt::format("its {} poses have {} different times: these were written to {:g} s only", poses,
                  poses - stamps.repeated, Seconds(stamps.step).count()),
      "Write the times with all digits: \"%.9f\" instead of \"%g\", which keeps six digits");
}

/// Pairs whose pose an earlier pair has, too.
std::size_t count_shared(const std::vector<MatchedPair>& pairs, std::size_t MatchedPair::*which) {
  std::set<std::size_t> used;
  for (const MatchedPair& pair : pairs) {
    used.insert(pair.*which);
  }
  return pairs.size() - used.size();
}

}  // namespace

StampQuality stamp_quality(const Trajectory& trajectory) {
  constexpr int64_t kCoarsest = 1'000'000'000'000'000'000;  // ns, the largest power of ten
  constexpr double kSame = 1e-6;  // m: poses that differ by less are the same, but for rounding
  StampQuality quality{.step = Nanoseconds(kCoarsest)};
  int64_t step = kCoarsest;
  for (std::size_t i = 0; i < trajectory.poses.size(); ++i) {
    const StampedPose& pose = trajectory.poses[i];
    while (pose.stamp.count() % step != 0) {
      step /= 10;
    }
    if (i == 0 || pose.stamp != trajectory.poses[i - 1].stamp) {
      continue;
    }
    const Eigen::Isometry3d apart = trajectory.poses[i - 1].pose.inverse() * pose.pose;
    const double distance = apart.translation().norm();
    ++quality.repeated;
    quality.conflicting += apart.matrix().isIdentity(kSame) ? 0U : 1U;
    quality.farthest = std::max(quality.farthest, distance);
  }
  quality.step = Nanoseconds(step);
  return quality;
}

Association associate(const Trajectory& estimate, const Trajectory& truth, double tolerance) {
  Association result;
  AssociationSummary& summary = result.summary;
  summary.estimate_poses = estimate.poses.size();
  summary.truth_poses = truth.poses.size();
  summary.by_time = estimate.stamped && truth.stamped;
  if (summary.by_time) {
    summary.estimate_stamps = stamp_quality(estimate);
    summary.truth_stamps = stamp_quality(truth);
    require_own_times(estimate, summary.estimate_stamps, tolerance);
    require_own_times(truth, summary.truth_stamps, tolerance);
    result.pairs = associate_by_time(estimate, truth, tolerance);
    for (const MatchedPair& pair : result.pairs) {
      const Seconds difference =
          std::chrono::abs(estimate.poses[pair.estimate].stamp - truth.poses[pair.truth].stamp);
      summary.largest_difference = std::max(summary.largest_difference, difference.count());
    }
  } else {
    for (std::size_t i = 0; i < std::min(summary.estimate_poses, summary.truth_poses); ++i) {
      result.pairs.push_back({i, i});
    }
  }
  summary.pairs = result.pairs.size();
  summary.shared_truth = count_shared(result.pairs, &MatchedPair::truth);
  summary.shared_estimate = count_shared(result.pairs, &MatchedPair::estimate);
  summary.covered_path =
      path_length(truth.poses, result.pairs.front().truth, result.pairs.back().truth);
  summary.truth_path = path_length(truth.poses, 0, truth.poses.size() - 1);
  return result;
}

}  // namespace adit
