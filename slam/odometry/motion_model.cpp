// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/motion_model.hpp"

#include <algorithm>

namespace adit {
namespace {

// After this many aligned sweeps the velocity has been seen twice.
constexpr int kTrustedAfter = 2;
constexpr double kLongestGuess = 5.0;       // s
constexpr double kHardlyMovesPartly = 1.0;  // m/s, along what few matches hold

}  // namespace

bool hardly_moves(const RegistrationResult& alignment, const StampedPose& from,
                  const StampedPose& to) {
  const double elapsed = std::max(seconds(to.stamp - from.stamp), 1e-3);
  const Eigen::Vector3d velocity =
      to.pose.linear().transpose() * (to.pose.translation() - from.pose.translation()) / elapsed;
  double held = 0.0;
  double partly = 0.0;
  for (const ObservedDirection& direction : alignment.translation) {
    const double along = direction.axis.dot(velocity);
    held += direction.localizability == Localizability::full ? along * along : 0.0;
    partly += direction.localizability == Localizability::partial ? along * along : 0.0;
  }
  return held < kHardlyMoves * kHardlyMoves &&
         held + partly < kHardlyMovesPartly * kHardlyMovesPartly;
}

Prediction MotionModel::predict(Nanoseconds stamp) const {
  if (!last_) {
    return {};
  }
  const double elapsed = seconds(stamp - last_->stamp);
  const double bridged = seconds(last_->stamp - seen_->stamp);
  const double left = std::max(0.0, kLongestExtrapolation - bridged);
  const double bounded = std::clamp(elapsed, 0.0, left);
  const bool trusted = aligned_in_a_row_ >= kTrustedAfter && elapsed == bounded;
  Prediction prediction;
  prediction.T_map_lidar = orthonormalized(last_->pose * se3_exp(bounded * velocity_));
  prediction.trusted = trusted;
  prediction.moving = aligned_in_a_row_ >= 1 && elapsed == bounded;
  prediction.lost = bridged + elapsed > kLongestExtrapolation;
  prediction.T_map_onward = orthonormalized(
      seen_->pose * se3_exp(std::clamp(bridged + elapsed, 0.0, kLongestGuess) * velocity_));
  return prediction;
}

void MotionModel::stop() {
  velocity_.setZero();
  velocity_before_.setZero();
  moved_ = false;
  aligned_in_a_row_ = 0;
}

// One motion alone may be an alignment that went astray, or between stamps a moment apart.
const Vector6d& MotionModel::slower_velocity() const {
  return velocity_.head<3>().norm() < velocity_before_.head<3>().norm() ? velocity_
                                                                        : velocity_before_;
}

Silence MotionModel::silence_until(Nanoseconds stamp) const {
  return silence_after(seen_->pose, moved_ ? std::optional(slower_velocity()) : std::nullopt,
                       fastest_, unseen(stamp));
}

void MotionModel::update(const StampedPose& pose, bool aligned) {
  if (aligned) {
    const double elapsed = seen_ ? seconds(pose.stamp - seen_->stamp) : 0.0;
    if (elapsed > kLongestExtrapolation) {
      stop();
    } else if (elapsed > 0.0) {
      const Vector6d velocity = se3_log(seen_->pose.inverse() * pose.pose) / elapsed;
      velocity_before_ = aligned_in_a_row_ > 0 ? velocity_ : velocity;
      velocity_ = velocity;
      moved_ = true;
      if (aligned_in_a_row_ > 0) {
        fastest_ = std::max(fastest_, slower_velocity().head<3>().norm());
      }
    }
    ++aligned_in_a_row_;
    seen_ = pose;
  } else {
    aligned_in_a_row_ = 0;
    seen_ = seen_ ? seen_ : pose;
  }
  last_ = pose;
}

void MotionModel::restart(const StampedPose& pose) {
  if (seen_ && seconds(pose.stamp - seen_->stamp) > kLongestExtrapolation) {
    stop();
  }
  last_ = pose;
  seen_ = pose;
  aligned_in_a_row_ = 0;
}

}  // namespace adit
