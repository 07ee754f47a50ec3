// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/pose_consistency.hpp"

#include <cmath>
#include <map>

#include <fmt/core.h>
#include <Eigen/Cholesky>
#include <nlohmann/json.hpp>

#include "adit/tools/evaluation/evaluate_association.hpp"

namespace adit {
namespace {

using nlohmann::ordered_json;

constexpr Nanoseconds kSecond = std::chrono::seconds(1);
constexpr double kBound = 3.0;  // sigma

template <int kSize>
double squared(const MotionError& one, int at) {
  const Eigen::Matrix<double, kSize, kSize> block = one.covariance.block<kSize, kSize>(at, at);
  const Eigen::Matrix<double, kSize, 1> part = one.error.segment<kSize>(at);
  return part.dot(block.ldlt().solve(part)) / kSize;
}

/// A sweep of the run with a truth.
struct Judged {
  std::size_t sweep = 0;  ///< in the table
  Nanoseconds stamp{0};
  JudgedPose pose;
};

std::vector<Judged> judged_sweeps(const RunReview& review, const Trajectory& estimate,
                                  const Trajectory& truth, double tolerance) {
  std::map<Nanoseconds, std::size_t> by_stamp;
  for (std::size_t i = 0; i < review.sweeps.size(); ++i) {
    by_stamp[review.sweeps[i].stamp] = i;
  }
  std::vector<Judged> judged;
  for (const MatchedPair& pair : associate(estimate, truth, tolerance).pairs) {
    const StampedPose& pose = estimate.poses[pair.estimate];
    const auto found = by_stamp.find(pose.stamp);
    if (found == by_stamp.end()) {
      continue;
    }
    const PoseUncertainty& uncertainty = review.sweeps[found->second].uncertainty;
    if (uncertainty.in_map().allFinite()) {
      judged.push_back({.sweep = found->second,
                        .stamp = pose.stamp,
                        .pose = {.estimate = {pose.stamp, pose.pose, uncertainty},
                                 .T_world_lidar = truth.poses[pair.truth].pose}});
    }
  }
  return judged;
}

}  // namespace

ordered_json to_json(const Nees& nees) {
  return {{"pose", nees.pose},
          {"translation", nees.translation},
          {"rotation", nees.rotation},
          {"samples", nees.samples}};
}

MotionError motion_error(const JudgedPose& from, const JudgedPose& to) {
  const Eigen::Isometry3d truth = from.T_world_lidar.inverse() * to.T_world_lidar;
  const Eigen::Isometry3d estimate = from.estimate.T_map_lidar.inverse() * to.estimate.T_map_lidar;
  const Eigen::Isometry3d off = truth.inverse() * estimate;
  MotionError found;
  found.error << off.translation(), so3_log(off.linear());
  found.covariance = motion_covariance(from.estimate, to.estimate);
  return found;
}

void Nees::add(const MotionError& one) {
  ++samples;
  const auto n = static_cast<double>(samples);
  pose += (squared<6>(one, 0) - pose) / n;
  translation += (squared<3>(one, 0) - translation) / n;
  rotation += (squared<3>(one, 3) - rotation) / n;
}

std::optional<PoseConsistency> pose_consistency(const RunReview& review, const Trajectory& estimate,
                                                const Trajectory& truth, double tolerance) {
  const std::vector<Judged> judged = judged_sweeps(review, estimate, truth, tolerance);
  if (judged.size() < 2) {
    return std::nullopt;
  }
  PoseConsistency found;
  found.errors.resize(review.sweeps.size(), Vector6d::Constant(kUnknown));
  found.sigmas = found.errors;
  std::size_t before = 0;  // the newest sweep a second or more before
  std::size_t beyond = 0;
  for (std::size_t i = 1; i < judged.size(); ++i) {
    const MotionError since_first = motion_error(judged.front().pose, judged[i].pose);
    const Vector6d sigma = since_first.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    found.errors[judged[i].sweep] = since_first.error;
    found.sigmas[judged[i].sweep] = sigma;
    found.since_first.add(since_first);
    beyond += static_cast<std::size_t>(
        (since_first.error.array().abs() > kBound * sigma.array()).count());
    while (judged[before + 1].stamp + kSecond <= judged[i].stamp) {
      ++before;
    }
    if (judged[before].stamp + kSecond <= judged[i].stamp) {
      found.second.add(motion_error(judged[before].pose, judged[i].pose));
    }
  }
  found.beyond = static_cast<double>(beyond) / (6.0 * static_cast<double>(judged.size() - 1));
  return found;
}

std::string describe(const PoseConsistency& found) {
  const Nees& nees = found.since_first;
  std::string text = fmt::format(
      "consistency  squared error of the pose since the first sweep {:.2f} per degree of freedom "
      "(NEES; 1: as its covariance promises; translation {:.2f}, rotation {:.2f})",
      nees.pose, nees.translation, nees.rotation);
  if (found.second.samples > 0) {
    text += fmt::format(", of the motion over a second {:.2f}", found.second.pose);
  }
  return text + fmt::format("; {:.1f} % beyond 3 sigma\n", 100.0 * found.beyond);
}

ordered_json to_json(const PoseConsistency& found) {
  return {{"nees_per_degree_since_first_sweep", to_json(found.since_first)},
          {"nees_per_degree_over_1_s", to_json(found.second)},
          {"beyond_3_sigma", found.beyond}};
}

}  // namespace adit
