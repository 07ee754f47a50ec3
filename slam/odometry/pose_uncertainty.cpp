// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/pose_uncertainty.hpp"

#include <cmath>

namespace adit {
namespace {

// Share of its variance that a joining cloud leaves behind for good, once the first have left: as
// measured. An average of l clouds with independent errors would keep (2 / (l + 1))^2.
constexpr double kKept = 0.15;

// s. Two poses err alike where they are much less apart.
constexpr double kAlike = 0.8;
// What a way of 1 m, and a turn of 1 rad, leave behind that no sweep's own covariance tells:
// standard deviations. The errors of real lidars' beams and clocks are of that size
// (docs/theory/inertial.md, section 9).
constexpr double kTranslationAMetre = 0.0007;  // m
constexpr double kRotationAMetre = 0.00035;    // rad
constexpr double kRotationARadian = 0.001;     // rad

// A covariance of T_map_a as one of T_map_b, where b moves with a.
Matrix6d moved(const Matrix6d& covariance, const Eigen::Isometry3d& T_a_b) {
  const Matrix6d to_b = adjoint(T_a_b.inverse());
  return to_b * covariance * to_b.transpose();
}

// What a way leaves behind that no sweep's own covariance tells.
Matrix6d systematic(const Eigen::Isometry3d& way) {
  const double metres = way.translation().norm();
  const double radians = rotation_angle(way.linear());
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(std::pow(kTranslationAMetre, 2) * metres),
      Eigen::Vector3d::Constant(std::pow(kRotationAMetre, 2) * metres +
                                std::pow(kRotationARadian, 2) * radians);
  return variances.asDiagonal();
}

}  // namespace

Matrix6d motion_covariance(const UncertainPose& from, const UncertainPose& to) {
  const Eigen::Isometry3d T_from_to = from.T_map_lidar.inverse() * to.T_map_lidar;
  const double apart = 1.0 - std::exp(-std::abs(seconds(to.stamp - from.stamp)) / kAlike);
  return apart * (to.uncertainty.local + moved(from.uncertainty.local, T_from_to)) +
         to.uncertainty.drift - moved(from.uncertainty.drift, T_from_to);
}

PoseUncertainty DriftModel::update(const Eigen::Isometry3d& T_map_lidar, const Matrix6d& local,
                                   bool joins) {
  if (last_) {
    const Eigen::Isometry3d step = last_->inverse() * T_map_lidar;
    drift_ = moved(drift_, step) + systematic(step);
  }
  last_ = T_map_lidar;
  const PoseUncertainty uncertainty{.local = local, .drift = drift_};
  if (joins && ++joined_ > clouds_) {
    drift_ += kKept * local;
  }
  return uncertainty;
}

void DriftModel::begin_vaguely(const Vector6d& sigma) {
  drift_ += sigma.cwiseAbs2().asDiagonal();
}

PoseUncertainty DriftModel::restart(const Matrix6d& local) {
  drift_ += local;
  joined_ = 1;
  return {.local = Matrix6d::Zero(), .drift = drift_};
}

}  // namespace adit
