// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/pose_uncertainty.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace adit {
namespace {

// Share of its variance that a joining cloud leaves behind for good, at the least: as measured. An
// average of l clouds with independent errors would keep (2 / (l + 1))^2.
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
// No sensor that is carried or driven accelerates by more.
constexpr double kMostAcceleration = 15.0;  // m/s^2
constexpr double kMostTurning = 20.0;       // rad/s^2
// s. Times between sweeps are off by as much where stamps are rounded, as KITTI's are.
constexpr double kStampsOff = 0.01;
constexpr double kMostOffInTime = 0.2;  // of the time between two sweeps

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

// What a cloud with this local covariance leaves behind in the submap, where the sweep after it has
// that of `now`: both relative to the submap, at the same lidar. By as much as a direction is known
// better than before, it is known by the new cloud, and no better than that cloud is.
Matrix6d left_behind(const Matrix6d& joined, const Matrix6d& now) {
  if (Eigen::LLT<Matrix6d>(now).info() != Eigen::Success) {
    return kKept * joined;
  }
  // Directions whose errors are independent in both, with the one's variances over the other's.
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> common(joined, now);
  const Vector6d ratio = common.eigenvalues().cwiseMax(0.0);
  const Vector6d by_it = (1.0 - ratio.cwiseMax(1.0).cwiseInverse().array()).matrix();
  const Vector6d kept = by_it.cwiseAbs2().cwiseMax(kKept).cwiseProduct(ratio);
  const Matrix6d directions = now * common.eigenvectors();
  return directions * kept.asDiagonal() * directions.transpose();
}

// Without what is below zero: what was taken for drift at the first of two poses, and then found
// to be none.
Matrix6d at_least_zero(const Matrix6d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> parts(covariance);
  if (parts.eigenvalues()[0] >= 0.0) {
    return covariance;
  }
  return parts.eigenvectors() * parts.eigenvalues().cwiseMax(0.0).asDiagonal() *
         parts.eigenvectors().transpose();
}

}  // namespace

Matrix6d motion_covariance(const UncertainPose& from, const UncertainPose& to) {
  const Eigen::Isometry3d T_from_to = from.T_map_lidar.inverse() * to.T_map_lidar;
  const double apart = 1.0 - std::exp(-std::abs(seconds(to.stamp - from.stamp)) / kAlike);
  return apart * (to.uncertainty.local + moved(from.uncertainty.local, T_from_to)) +
         at_least_zero(to.uncertainty.drift - moved(from.uncertainty.drift, T_from_to));
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

Matrix6d UnmeasuredMotion::step(const StampedPose& found, const Eigen::Isometry3d& steady,
                                const Matrix6d& unheld) {
  const double elapsed = last_ ? seconds(found.stamp - last_->stamp) : 0.0;
  Matrix6d added = walk(found.pose.linear(), unheld, elapsed);
  leapt_ = false;
  if (step_ > 0.0) {
    const Vector6d expected = se3_log(last_->pose.inverse() * steady);
    added += leap(steady.inverse() * found.pose, expected, elapsed);
  }
  step_ = elapsed;
  last_ = found;
  return added;
}

// Constant velocity is all there is along what no match holds, and a velocity that nothing measures
// walks away. Its error reverts within some seconds (who drives does not drive off for ever), so
// that the position's grows as time^1.5 at first and as its root in the long run.
Matrix6d UnmeasuredMotion::walk(const Eigen::Matrix3d& R_map_lidar, const Matrix6d& unheld,
                                double elapsed) {
  Matrix6d R = Matrix6d::Zero();
  R.topLeftCorner<3, 3>() = R_map_lidar;
  R.bottomRightCorner<3, 3>() = R_map_lidar;
  const Matrix6d open = R * unheld * R.transpose();
  // What was not known of the velocity, and is now, has ended.
  velocity_ = (open * velocity_ * open).eval();
  mixed_ = (mixed_ * open).eval();
  Vector6d density;
  density << Eigen::Vector3d::Constant(kAcceleration * kAcceleration),
      Eigen::Vector3d::Constant(kTurning * kTurning);
  const Matrix6d noise = open * density.asDiagonal() * open;
  const double t = elapsed;
  const Matrix6d grown =
      t * (mixed_ + mixed_.transpose()) + t * t * velocity_ + (t * t * t / 3.0) * noise;
  const double left = std::exp(-t / kVelocityLasts);
  mixed_ = (left * (mixed_ + t * velocity_ + 0.5 * t * t * noise)).eval();
  velocity_ = (left * left * velocity_ + t * noise).eval();
  return R.transpose() * open * grown * open * R;
}

// Of a step that takes more acceleration than any sensor has, it or the ones before are wrong by as
// much, and nothing tells which. A stamp that is off makes none: at 20 m/s, 10 ms are 20 cm.
Matrix6d UnmeasuredMotion::leap(const Eigen::Isometry3d& T_steady_found, const Vector6d& expected,
                                double elapsed) {
  const Vector6d off = se3_log(T_steady_found);
  // The velocity is that of the middle of the step before.
  const double lasts = 0.5 * elapsed * (elapsed + step_);
  const double off_in_time = std::min(kStampsOff / elapsed, kMostOffInTime);
  leapt_ =
      off.head<3>().norm() > kMostAcceleration * lasts + off_in_time * expected.head<3>().norm() ||
      off.tail<3>().norm() > kMostTurning * lasts + off_in_time * expected.tail<3>().norm();
  return leapt_ ? Matrix6d(off.cwiseAbs2().asDiagonal()) : Matrix6d(Matrix6d::Zero());
}

PoseUncertainty DriftModel::update(const Eigen::Isometry3d& T_map_lidar, const Matrix6d& local,
                                   bool joins, const Matrix6d& besides) {
  if (last_) {
    const Eigen::Isometry3d step = last_->inverse() * T_map_lidar;
    drift_ = moved(drift_, step) + systematic(step) + besides;
    if (newest_) {
      drift_ += left_behind(moved(*newest_, step), local);
    }
  }
  last_ = T_map_lidar;
  newest_ = joins ? std::optional(local) : std::nullopt;
  return {.local = local, .drift = drift_};
}

void DriftModel::begin_vaguely(const Vector6d& sigma) {
  drift_ += sigma.cwiseAbs2().asDiagonal();
}

void DriftModel::note_rest() {
  drift_.setZero();
  newest_.reset();
}

PoseUncertainty DriftModel::restart(const Matrix6d& local) {
  drift_ += local;
  newest_.reset();
  return {.local = Matrix6d::Zero(), .drift = drift_};
}

}  // namespace adit
