// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/pose_uncertainty.hpp"

namespace adit {
namespace {

// Share of its variance that a joining cloud leaves behind for good, once the first have left: as
// measured. An average of l clouds with independent errors would keep (2 / (l + 1))^2.
constexpr double kKept = 0.15;

// A covariance of T_map_a as one of T_map_b, where b moves with a.
Matrix6d moved(const Matrix6d& covariance, const Eigen::Isometry3d& T_a_b) {
  const Matrix6d to_b = adjoint(T_a_b.inverse());
  return to_b * covariance * to_b.transpose();
}

}  // namespace

Matrix6d motion_covariance(const UncertainPose& from, const UncertainPose& to) {
  const Eigen::Isometry3d T_from_to = from.T_map_lidar.inverse() * to.T_map_lidar;
  return to.uncertainty.in_map() + moved(from.uncertainty.local, T_from_to) -
         moved(from.uncertainty.drift, T_from_to);
}

PoseUncertainty DriftModel::update(const Eigen::Isometry3d& T_map_lidar, const Matrix6d& local,
                                   bool joins) {
  if (last_) {
    drift_ = moved(drift_, last_->inverse() * T_map_lidar);
  }
  last_ = T_map_lidar;
  const PoseUncertainty uncertainty{.local = local, .drift = drift_};
  if (joins && ++joined_ > clouds_) {
    drift_ += kKept * local;
  }
  return uncertainty;
}

PoseUncertainty DriftModel::restart(const Matrix6d& local) {
  drift_ += local;
  joined_ = 1;
  return {.local = Matrix6d::Zero(), .drift = drift_};
}

}  // namespace adit
