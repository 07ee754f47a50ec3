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

// A velocity that nothing measures: what white noise in acceleration makes of it, and how long it
// lasts, s. In the long run 1.6 m/s and 0.5 rad/s.
constexpr double kAcceleration = 1.0;  // m/s^2 / sqrt(Hz)
constexpr double kTurning = 0.3;       // rad/s^2 / sqrt(Hz)
constexpr double kVelocityLasts = 5.0;

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

Matrix6d unheld_directions(const RegistrationResult& alignment) {
  Matrix6d unheld = Matrix6d::Zero();
  for (size_t i = 0; i < 3; ++i) {
    const ObservedDirection& way = alignment.translation[i];
    const ObservedDirection& turn = alignment.rotation[i];
    if (way.localizability == Localizability::none) {
      unheld.topLeftCorner<3, 3>() += way.axis * way.axis.transpose();
    }
    if (turn.localizability == Localizability::none) {
      unheld.bottomRightCorner<3, 3>() += turn.axis * turn.axis.transpose();
    }
  }
  return unheld;
}

Matrix6d UnheldMotion::step(const StampedPose& T_map_lidar, const Matrix6d& unheld) {
  const double t = last_ ? seconds(T_map_lidar.stamp - *last_) : 0.0;
  last_ = T_map_lidar.stamp;
  Matrix6d R_map_lidar = Matrix6d::Zero();
  R_map_lidar.topLeftCorner<3, 3>() = T_map_lidar.pose.linear();
  R_map_lidar.bottomRightCorner<3, 3>() = T_map_lidar.pose.linear();
  const Matrix6d held_out = R_map_lidar * unheld * R_map_lidar.transpose();
  // What was not known of the velocity, and is now, has ended; its noise is along what is unheld.
  velocity_ = (held_out * velocity_ * held_out).eval();
  mixed_ = (mixed_ * held_out).eval();
  Vector6d density;
  density << Eigen::Vector3d::Constant(kAcceleration * kAcceleration),
      Eigen::Vector3d::Constant(kTurning * kTurning);
  const Matrix6d noise = held_out * density.asDiagonal() * held_out;
  const Matrix6d grown =
      t * (mixed_ + mixed_.transpose()) + t * t * velocity_ + (t * t * t / 3.0) * noise;
  const double left = std::exp(-t / kVelocityLasts);
  mixed_ = (left * (mixed_ + t * velocity_ + 0.5 * t * t * noise)).eval();
  velocity_ = (left * left * velocity_ + t * noise).eval();
  return R_map_lidar.transpose() * held_out * grown * held_out * R_map_lidar;
}

PoseUncertainty DriftModel::update(const Eigen::Isometry3d& T_map_lidar, const Matrix6d& local,
                                   bool joins, const Matrix6d& walked) {
  if (last_) {
    const Eigen::Isometry3d step = last_->inverse() * T_map_lidar;
    drift_ = moved(drift_, step) + systematic(step) + walked;
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
