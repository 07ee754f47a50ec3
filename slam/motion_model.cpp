// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "slam/motion_model.hpp"

#include <algorithm>

namespace adit {
namespace {

// After this many aligned sweeps the velocity has been seen twice.
constexpr int kTrustedAfter = 2;
// Nobody moves at constant velocity for longer than this.
constexpr double kLongestExtrapolation = 1.0;  // s

double seconds(Nanoseconds duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

Prediction MotionModel::predict(Nanoseconds stamp) const {
  if (!last_) {
    return {};
  }
  const double elapsed = seconds(stamp - last_->stamp);
  const double bounded = std::clamp(elapsed, 0.0, kLongestExtrapolation);
  const bool trusted = aligned_in_a_row_ >= kTrustedAfter && elapsed == bounded;
  Prediction prediction;
  prediction.T_map_lidar = orthonormalized(last_->pose * se3_exp(bounded * velocity_));
  prediction.trusted = trusted;
  return prediction;
}

void MotionModel::update(const StampedPose& pose, bool aligned) {
  if (aligned) {
    const double elapsed = last_ ? seconds(pose.stamp - last_->stamp) : 0.0;
    if (elapsed > 0.0) {
      velocity_before_ = velocity_;
      velocity_ = se3_log(last_->pose.inverse() * pose.pose) / elapsed;
    }
    ++aligned_in_a_row_;
  } else {
    aligned_in_a_row_ = 0;
  }
  last_ = pose;
}

void MotionModel::restart(const StampedPose& pose) {
  last_ = pose;
  aligned_in_a_row_ = 0;
}

}  // namespace adit
