// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Twin of registration_linearize.comp for voxelised GICP (Koide et al., ICRA 2021) with weight 1 a
// match. Tangent vectors are [rho, phi] in the map's axes about the source's origin: R <- Exp(phi)
// R, t <- t + rho.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "adit/benchmarks/reference/voxel_map.hpp"
#include "adit/slam/core/lie.hpp"

namespace adit::reference {

/// Eigenvalues of the regularised covariances are (epsilon, 1, 1).
inline constexpr double kPlaneEpsilon = 1e-3;

/// What an alignment is run with; lengths in m, the angle in rad.
struct AlignmentSettings {
  double d_max = 0.0;
  double translation_epsilon = 0.0;
  double rotation_epsilon = 0.0;
  uint32_t max_iterations = 0;
};

/// A source point with the voxel it falls into.
struct Match {
  size_t source = 0;                                            ///< index of the source point
  Eigen::Vector3d rotated = Eigen::Vector3d::Zero();            ///< R a
  Eigen::Vector3d error = Eigen::Vector3d::Zero();              ///< e = mean - (R a + t)
  Eigen::Matrix3d target_constraint = Eigen::Matrix3d::Zero();  ///< mean P of the voxel
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();        ///< Omega
};

/// Sums over all matches.
struct System {
  Matrix6d hessian = Matrix6d::Zero();   ///< sum of J^T Omega J
  Vector6d gradient = Vector6d::Zero();  ///< sum of J^T Omega e
  double cost = 0.0;                     ///< sum of e^T Omega e
  double squared_distance = 0.0;         ///< sum of e^T P e: along the target's normals, m^2
  int64_t inliers = 0;
};

/// Every source point that falls into a voxel whose mean is at most d_max away, in order of the
/// source.
inline std::vector<Match> find_matches(std::span<const SurfacePoint> source, const VoxelMap& target,
                                       const Eigen::Isometry3d& pose, double d_max) {
  std::vector<Match> matches;
  for (size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector3d q = pose * source[i].p;
    const Place place = place_of(q, target.voxel_size);
    const auto found = target.voxels.find(place.cell);
    if (found == target.voxels.end()) {
      continue;
    }
    const Voxel& voxel = found->second;
    Match match{.source = i, .rotated = pose.linear() * source[i].p};
    match.error = voxel.mean(place.cell, target.voxel_size) - q;
    if (match.error.norm() > d_max || is_other_face(pose.linear() * facing_normal(source[i]),
                                                    voxel.faces(), voxel.constraint())) {
      continue;
    }
    match.target_constraint = voxel.constraint();
    const Eigen::Matrix3d source_constraint =
        pose.linear() * source[i].constraint() * pose.linear().transpose();
    const Eigen::Matrix3d covariance_sum =
        2.0 * Eigen::Matrix3d::Identity() -
        (1.0 - kPlaneEpsilon) * (match.target_constraint + source_constraint);
    match.information = covariance_sum.inverse();
    matches.push_back(match);
  }
  return matches;
}

/// de/d[rho, phi] = [-I, [R a]x].
inline Eigen::Matrix<double, 3, 6> jacobian(const Match& match) {
  Eigen::Matrix<double, 3, 6> j;
  j << -Eigen::Matrix3d::Identity(), skew(match.rotated);
  return j;
}

inline System linearize(std::span<const Match> matches) {
  System system;
  for (const Match& match : matches) {
    const Eigen::Matrix<double, 3, 6> j = jacobian(match);
    system.hessian += j.transpose() * match.information * j;
    system.gradient += j.transpose() * match.information * match.error;
    system.cost += match.error.dot(match.information * match.error);
    system.squared_distance += match.error.dot(match.target_constraint * match.error);
    system.inliers += 1;
  }
  return system;
}

/// The Gauss-Newton step, damped by 1e-6 of H's diagonal.
inline Vector6d step_of(const System& system) {
  Matrix6d damped = system.hessian;
  damped.diagonal() *= 1.0 + 1e-6;
  return -damped.ldlt().solve(system.gradient);
}

/// How much of Gauss-Newton's steps is taken. Those that go on the same way (within 37 degrees) and
/// shrink by r each are made 1 / (1 - r) times as long, twice at most; one that goes back, and
/// more than half as far as the last one went, is halved, and no later one is longer. Measured in
/// units of 1 / sqrt(H_ii).
struct StepLength {
  double factor = 1.0;
  double most = 2.0;
  Vector6d last = Vector6d::Zero();  ///< Gauss-Newton's

  Vector6d scaled(const Vector6d& step, const Matrix6d& hessian) {
    const Vector6d now = step.cwiseProduct(hessian.diagonal().cwiseSqrt());
    const double along = now.dot(last);
    if (along < 0.0 && now.norm() > 0.5 * factor * last.norm()) {
      most = 0.5 * std::min(factor, 1.0);
    }
    const bool same_way = along > 0.8 * now.norm() * last.norm();
    const double shrinking = along / std::max(last.squaredNorm(), 1e-30);
    const double wanted = same_way ? factor / std::max(1.0 - shrinking, 1e-3) : 1.0;
    factor = std::min(std::max(wanted, 1.0), most);
    last = now;
    return factor * step;
  }
};

/// The pose after a step in map axes.
inline Eigen::Isometry3d move(const Eigen::Isometry3d& pose, const Vector6d& step) {
  Eigen::Isometry3d moved = pose;
  moved.linear() = so3_exp(step.tail<3>()) * pose.linear();
  moved.translation() += step.head<3>();
  return moved;
}

struct Alignment {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  System system{};  ///< at the pose; where the alignment failed, the one it failed with
  uint32_t iterations = 0;
  bool converged = false;
  bool failed = false;  ///< fewer than 6 matches, or no finite step
};

/// The whole loop: steps until one is short enough or max_iterations were taken, then an
/// evaluation.
inline Alignment align(std::span<const SurfacePoint> source, const VoxelMap& target,
                       const Eigen::Isometry3d& start, const AlignmentSettings& settings) {
  Alignment alignment{.pose = start};
  StepLength length;
  while (!alignment.converged && alignment.iterations < settings.max_iterations) {
    alignment.system = linearize(find_matches(source, target, alignment.pose, settings.d_max));
    const Vector6d step = length.scaled(step_of(alignment.system), alignment.system.hessian);
    if (alignment.system.inliers < 6 || !step.allFinite()) {
      alignment.failed = true;
      return alignment;
    }
    alignment.pose = move(alignment.pose, step);
    alignment.iterations += 1;
    alignment.converged = step.head<3>().norm() < settings.translation_epsilon &&
                          step.tail<3>().norm() < settings.rotation_epsilon;
  }
  alignment.system = linearize(find_matches(source, target, alignment.pose, settings.d_max));
  return alignment;
}

}  // namespace adit::reference
