// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Errors of poses beside a truth, against what their covariances say of them
// (docs/theory/inertial.md, section 9).
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "adit/slam/odometry/pose_uncertainty.hpp"
#include "adit/tools/evaluation/run_review.hpp"
#include "adit/tools/results/trajectory_io.hpp"

namespace adit {

/// A pose beside its truth.
struct JudgedPose {
  UncertainPose estimate;
  Eigen::Isometry3d T_world_lidar = Eigen::Isometry3d::Identity();  ///< the truth
};

/// How an estimated motion differs from the true one.
struct MotionError {
  Vector6d error = Vector6d::Zero();       ///< [rho, phi] at its end, lidar axes, m and rad
  Matrix6d covariance = Matrix6d::Zero();  ///< the error's, as the estimate has it
};
MotionError motion_error(const JudgedPose& from, const JudgedPose& to);

/// Normalised estimation error squared, means a degree of freedom: 1 where the covariance is right.
struct Nees {
  double pose = 0.0;
  double translation = 0.0;
  double rotation = 0.0;
  std::size_t samples = 0;

  void add(const MotionError& one);
};
nlohmann::ordered_json to_json(const Nees& nees);

/// A run's poses beside the truth. The first that has one is taken for right: what is judged is the
/// motion since then.
struct PoseConsistency {
  /// One a sweep, [rho, phi], m and rad; NaN where there is no truth.
  std::vector<Vector6d> errors;
  std::vector<Vector6d> sigmas;  ///< standard deviations of these
  Nees since_first;
  Nees second;  ///< motion over a second
  /// Share of the six errors of all sweeps beyond three sigma; 0.003 is right.
  double beyond = 0.0;
};

/// Nothing where the table of the run has no covariances, or fewer than two sweeps have a truth.
/// `tolerance` (s) as for associate(); throws InputError where nothing matches.
std::optional<PoseConsistency> pose_consistency(const RunReview& review, const Trajectory& estimate,
                                                const Trajectory& truth, double tolerance);

/// One line for people, and for programs.
std::string describe(const PoseConsistency& found);
nlohmann::ordered_json to_json(const PoseConsistency& found);

}  // namespace adit
