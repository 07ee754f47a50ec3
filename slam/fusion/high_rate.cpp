// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/high_rate.hpp"

#include <algorithm>

#include "adit/slam/inertial/imu_buffer.hpp"

namespace adit {
namespace {

constexpr Nanoseconds kKept = std::chrono::seconds(2);

/// How a covariance grows along an increment: the error's transition, and the increment's own.
StateMatrix propagated(const StateEstimate& base, const Preintegration& since) {
  const Eigen::Matrix3d R = base.state.T_map_body.linear();
  const MotionIncrement& increment = since.increment;
  const Eigen::Matrix3d back = increment.rotation.transpose();
  const double t = since.duration;
  StateMatrix transition = StateMatrix::Identity();
  transition.block<3, 3>(kPositionAt, kPositionAt) = back;
  transition.block<3, 3>(kPositionAt, kRotationAt) = -back * skew(increment.position);
  transition.block<3, 3>(kPositionAt, kVelocityAt) = t * back * R.transpose();
  transition.block<3, 3>(kPositionAt, kGyroBiasAt) = back * since.position_by_gyro;
  transition.block<3, 3>(kPositionAt, kAccelBiasAt) = back * since.position_by_accel;
  const Eigen::Vector3d& gravity = base.state.gravity_map;
  const Eigen::Matrix<double, 3, 2> gravity_turn = -skew(gravity) * across(gravity);
  transition.block<3, 2>(kPositionAt, kGravityAt) =
      0.5 * t * t * back * R.transpose() * gravity_turn;
  transition.block<3, 2>(kVelocityAt, kGravityAt) = t * gravity_turn;
  transition.block<3, 3>(kRotationAt, kRotationAt) = back;
  transition.block<3, 3>(kRotationAt, kGyroBiasAt) = since.rotation_by_gyro;
  transition.block<3, 3>(kVelocityAt, kRotationAt) = -R * skew(increment.velocity);
  transition.block<3, 3>(kVelocityAt, kGyroBiasAt) = R * since.velocity_by_gyro;
  transition.block<3, 3>(kVelocityAt, kAccelBiasAt) = R * since.velocity_by_accel;
  Eigen::Matrix<double, kStateSize, 9> own = Eigen::Matrix<double, kStateSize, 9>::Zero();
  own.block<3, 3>(kPositionAt, 0) = back;
  own.block<3, 3>(kRotationAt, 3).setIdentity();
  own.block<3, 3>(kVelocityAt, 6) = R;
  return transition * base.covariance * transition.transpose() +
         own * whole_covariance(since) * own.transpose();
}

}  // namespace

void HighRateOdometry::correct(const StateEstimate& estimate) {
  const bool had = base_.has_value() && !readings_.empty();
  const ImuSample newest = readings_.empty() ? ImuSample{} : readings_.back();
  const Eigen::Isometry3d before =
      had ? forecast(newest).nav.T_map_body : Eigen::Isometry3d::Identity();

  base_ = estimate;
  since_ = {};
  since_.bias = estimate.state.bias;
  const Nanoseconds stamp = estimate.state.stamp;
  while (readings_.size() >= 2 && readings_[1].stamp <= stamp) {
    readings_.pop_front();
  }
  if (readings_.size() >= 2 && readings_.front().stamp < stamp) {
    readings_.front() = interpolate(readings_[0], readings_[1], stamp);
  }
  for (size_t i = 1; i < readings_.size(); ++i) {
    since_ = advanced(since_, readings_[i - 1], readings_[i], noise_);
  }
  if (had && smoothing_ > 0.0) {
    correction_.setZero();
    const Eigen::Isometry3d after = forecast(newest).nav.T_map_body;
    const Eigen::Isometry3d off = after.inverse() * before;
    correction_ << off.translation(), so3_log(off.linear());
    corrected_at_ = newest.stamp;
  }
}

void HighRateOdometry::stop() {
  base_.reset();
  readings_.clear();
  correction_.setZero();
}

std::optional<HighRateState> HighRateOdometry::add(const ImuSample& sample) {
  if (!readings_.empty() && sample.stamp <= readings_.back().stamp) {
    return std::nullopt;
  }
  if (!readings_.empty() && base_) {
    since_ = advanced(since_, readings_.back(), sample, noise_);
  }
  readings_.push_back(sample);
  while (readings_.front().stamp < sample.stamp - kKept) {
    readings_.pop_front();
  }
  if (!base_ || sample.stamp < base_->state.stamp) {
    return std::nullopt;
  }
  return forecast(sample);
}

HighRateState HighRateOdometry::forecast(const ImuSample& at) const {
  HighRateState result;
  result.nav = predict(base_->state, since_);
  result.nav.stamp = at.stamp;
  result.angular_velocity = at.angular_velocity - base_->state.bias.gyro;
  result.covariance = propagated(*base_, since_);
  const double passed = seconds(at.stamp - corrected_at_);
  const double left = smoothing_ > 0.0 ? std::clamp(1.0 - passed / smoothing_, 0.0, 1.0) : 0.0;
  result.nav.T_map_body = retract(result.nav.T_map_body, Vector6d(left * correction_));
  return result;
}

}  // namespace adit
