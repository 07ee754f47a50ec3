// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/evaluate_metrics.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/units.hpp"

namespace adit {
namespace {

/// The motion that is left between what the truth and what the estimate did from pose i to pose j.
Eigen::Isometry3d relative_error(Poses estimate, Poses truth, std::size_t i, std::size_t j) {
  const Eigen::Isometry3d true_motion = truth[i].inverse() * truth[j];
  const Eigen::Isometry3d estimated_motion = estimate[i].inverse() * estimate[j];
  return true_motion.inverse() * estimated_motion;
}

}  // namespace

Statistics statistics(std::span<const double> errors) {
  Statistics result;
  result.count = errors.size();
  if (errors.empty()) {
    return result;
  }
  const auto n = static_cast<double>(errors.size());
  std::vector<double> sorted(errors.begin(), errors.end());
  std::sort(sorted.begin(), sorted.end());
  double sum = 0.0;
  for (const double error : errors) {
    sum += error;
    result.sse += error * error;
  }
  result.mean = sum / n;
  result.rmse = std::sqrt(result.sse / n);
  double squared_deviations = 0.0;
  for (const double error : errors) {
    squared_deviations += (error - result.mean) * (error - result.mean);
  }
  result.std = std::sqrt(squared_deviations / n);
  const std::size_t middle = sorted.size() / 2;
  result.median =
      sorted.size() % 2 == 1 ? sorted[middle] : 0.5 * (sorted[middle - 1] + sorted[middle]);
  result.min = sorted.front();
  result.max = sorted.back();
  return result;
}

std::vector<double> path_lengths(Poses poses) {
  std::vector<double> lengths(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    lengths[i] = lengths[i - 1] + (poses[i].translation() - poses[i - 1].translation()).norm();
  }
  return lengths;
}

std::vector<double> position_errors(Poses estimate, Poses truth) {
  assert(estimate.size() == truth.size());
  std::vector<double> errors(truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    errors[i] = (estimate[i].translation() - truth[i].translation()).norm();
  }
  return errors;
}

std::vector<double> rotation_errors(Poses estimate, Poses truth) {
  assert(estimate.size() == truth.size());
  std::vector<double> errors(truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    errors[i] =
        kDegreesPerRadian * rotation_angle(truth[i].linear().transpose() * estimate[i].linear());
  }
  return errors;
}

std::vector<IndexPair> pairs_by_frames(std::size_t poses, std::size_t delta) {
  assert(delta >= 1);
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; delta < poses && i < poses - delta; i += delta) {
    pairs.emplace_back(i, i + delta);
  }
  return pairs;
}

std::vector<IndexPair> pairs_by_distance(Poses poses, double delta, bool from_first_pose) {
  assert(delta > 0.0);
  std::vector<std::size_t> ends;
  if (from_first_pose && !poses.empty()) {
    ends.push_back(0);
  }
  double path = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    path += (poses[i].translation() - poses[i - 1].translation()).norm();
    if (path >= delta) {
      ends.push_back(i);
      path = 0.0;
    }
  }
  std::vector<IndexPair> pairs;
  for (std::size_t i = 1; i < ends.size(); ++i) {
    pairs.emplace_back(ends[i - 1], ends[i]);
  }
  return pairs;
}

RelativeErrors relative_errors(Poses estimate, Poses truth, const RpeOptions& options) {
  assert(estimate.size() == truth.size());
  const Poses path = options.pairs_from == PairSource::estimate ? estimate : truth;
  const std::vector<IndexPair> pairs =
      options.unit == DeltaUnit::frames
          ? pairs_by_frames(truth.size(), static_cast<std::size_t>(options.delta))
          : pairs_by_distance(path, options.delta, options.from_first_pose);
  std::vector<double> translations;
  std::vector<double> rotations;
  translations.reserve(pairs.size());
  rotations.reserve(pairs.size());
  for (const auto& [i, j] : pairs) {
    const Eigen::Isometry3d error = relative_error(estimate, truth, i, j);
    translations.push_back(error.translation().norm());
    rotations.push_back(kDegreesPerRadian * rotation_angle(error.linear()));
  }
  return {statistics(translations), statistics(rotations)};
}

std::vector<SegmentErrors> kitti_segment_errors(Poses estimate, Poses truth) {
  assert(estimate.size() == truth.size());
  constexpr std::array<double, 8> kLengths = {100, 200, 300, 400, 500, 600, 700, 800};  // m
  constexpr std::size_t kStep = 10;                                                     // poses
  const std::vector<double> path = path_lengths(truth);
  std::vector<SegmentErrors> result;
  SegmentErrors all;
  for (const double length : kLengths) {
    SegmentErrors errors;
    errors.length = length;
    for (std::size_t first = 0; first < path.size(); first += kStep) {
      const auto end = std::upper_bound(path.begin(), path.end(), path[first] + length);
      if (end == path.end()) {
        break;
      }
      const auto last = static_cast<std::size_t>(end - path.begin());
      const Eigen::Isometry3d error = relative_error(estimate, truth, first, last);
      errors.translation += error.translation().norm() / length;
      errors.rotation += rotation_angle(error.linear()) / length;
      ++errors.count;
    }
    if (errors.count == 0) {
      continue;
    }
    all.count += errors.count;
    all.translation += errors.translation;
    all.rotation += errors.rotation;
    errors.translation /= static_cast<double>(errors.count);
    errors.rotation /= static_cast<double>(errors.count);
    result.push_back(errors);
  }
  if (all.count > 0) {
    all.translation /= static_cast<double>(all.count);
    all.rotation /= static_cast<double>(all.count);
  }
  result.push_back(all);
  return result;
}

}  // namespace adit
