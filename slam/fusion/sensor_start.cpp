// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/sensor_start.hpp"

#include <utility>

namespace adit {
namespace {

// A start: this much of aligned sweeps, which at rest moved less than ...
constexpr double kStartDuration = 1.0;  // s
constexpr size_t kStartPoses = 8;
constexpr size_t kMostPoses = 24;
constexpr double kRestDistance = 0.05;  // m
constexpr double kRestTurn = 0.02;      // rad
// Constant velocity leads no farther (slam/odometry/motion_model.cpp): after that a sweep may be
// aligned in another place.
constexpr double kLongestUnaligned = 1.0;  // s

}  // namespace

void StartCollection::add(const StampedPose& T_map_body,
                          std::optional<std::vector<ImuSample>> since,
                          std::vector<Eigen::Vector3d> unheld) {
  if (since && !poses_.empty()) {
    readings_.push_back(std::move(*since));
  } else {
    clear();
  }
  poses_.push_back(T_map_body);
  unheld_.push_back(std::move(unheld));
  if (poses_.size() > kMostPoses) {
    poses_.pop_front();
    readings_.pop_front();
    unheld_.pop_front();
  }
}

void StartCollection::note_unaligned(Nanoseconds stamp) {
  if (!poses_.empty() && seconds(stamp - poses_.back().stamp) > kLongestUnaligned) {
    clear();
  }
}

void StartCollection::clear() {
  poses_.clear();
  readings_.clear();
  unheld_.clear();
}

StatePrior prior_of(const SensorStart& start, const CalibrationSigma& calibration) {
  const ImuStart& how = start.how;
  StateVector sigma;
  sigma << Eigen::Vector3d::Constant(0.02), Eigen::Vector3d::Constant(0.005),
      Eigen::Vector3d::Constant(how.velocity_sigma), how.bias_sigma.gyro, how.bias_sigma.accel,
      Eigen::Vector2d::Constant(how.gravity_sigma), calibration.scale,
      Eigen::Vector2d::Constant(calibration.turn);
  const StatePrior independent = independent_prior(start.state, sigma);
  if (!how.rest_sigma) {
    return independent;
  }
  StateQuadratic known;
  known.h = independent.root.transpose() * independent.root;
  const NavState& state = start.state;
  const Eigen::Vector3d mean =
      state.bias.accel - state.T_map_body.linear().transpose() * state.gravity_map;
  const StateFactor<3> rest = rest_factor(mean, state, *how.rest_sigma);
  known.h += rest.by_state.transpose() * rest.by_state;
  return prior_from(start.state, known);
}

StateFactor<3> rest_factor(const Eigen::Vector3d& reading, const NavState& state, double sigma) {
  const Eigen::Matrix3d& R = state.T_map_body.linear();
  const Eigen::Vector3d& gravity = state.gravity_map;
  const Eigen::Vector3d force = reading - state.bias.accel;
  StateFactor<3> factor;
  factor.residual = (R * force + gravity) / sigma;
  factor.by_state.block<3, 3>(0, kRotationAt) = -R * skew(force) / sigma;
  factor.by_state.block<3, 3>(0, kAccelBiasAt) = -R / sigma;
  factor.by_state.block<3, 2>(0, kGravityAt) = -skew(gravity) * across(gravity) / sigma;
  return factor;
}

std::optional<InertialHindrance> few_aligned(const StartCollection& collected) {
  const std::deque<StampedPose>& poses = collected.poses();
  const double duration = poses.empty() ? 0.0 : seconds(poses.back().stamp - poses.front().stamp);
  if (poses.size() >= kStartPoses && duration >= kStartDuration) {
    return std::nullopt;
  }
  return FewAligned{.sweeps = poses.size(),
                    .duration = duration,
                    .needed = kStartPoses,
                    .needed_duration = kStartDuration};
}

StartAttempt try_start(const StartCollection& collected, const InertialReadings& readings,
                       const ImuNoise& noise, const std::optional<FusedBefore>& before) {
  const std::deque<StampedPose>& poses = collected.poses();
  if (few_aligned(collected)) {
    return std::monostate{};
  }
  const StampedPose& first = poses.front();
  const StampedPose& last = poses.back();
  const Eigen::Isometry3d moved = first.pose.inverse() * last.pose;
  ImuStart how;
  if (moved.translation().norm() < kRestDistance && rotation_angle(moved.linear()) < kRestTurn) {
    how = start_at_rest(readings.between(first.stamp, last.stamp).samples, noise);
    how.gravity_map = kStandardGravity * (last.pose.linear() * -how.up_body);
  }
  // At rest with an implausible gravity: that no motion explains.
  if (!is_started(how.status) && how.status != ImuStartStatus::implausible) {
    how = start_in_motion(std::vector(poses.begin(), poses.end()),
                          std::vector(collected.readings().begin(), collected.readings().end()),
                          noise, std::vector(collected.unheld().begin(), collected.unheld().end()));
  }
  const bool may_turn = before && before->sign_assumed && how.status == ImuStartStatus::in_motion;
  if (is_started(how.status) && before && how.accel_scale != before->accel_scale &&
      !(may_turn && how.accel_scale == -before->accel_scale)) {
    return InertialHindrance(UnitChanged{});
  }
  if (!is_started(how.status)) {
    return InertialHindrance(how.reason);
  }
  if (may_turn && how.other_sign_error < 1.0) {
    return InertialHindrance(SignUnclear{});
  }
  return SensorStart{.state = {.stamp = last.stamp,
                               .T_map_body = last.pose,
                               .v_map_body = how.v_map_body,
                               .bias = how.bias,
                               .gravity_map = how.gravity_map,
                               .velocity = before ? before->state.velocity : VelocityCalibration{}},
                     .how = how,
                     .since = first.stamp};
}

SensorStart start_after_gap(const StartCollection& collected, const ImuNoise& noise,
                            const FusedBefore& before) {
  const StampedPose& first = collected.poses()[collected.poses().size() - 2];
  const StampedPose& last = collected.poses().back();
  const NavState& known = before.state;
  const std::vector<ImuSample>& samples = collected.readings().back();
  const Preintegration between = preintegrate(
      before.accel_scale == 1.0 ? samples : with_accel_scale(samples, before.accel_scale),
      known.bias, noise);
  ImuStart how;
  how.status = ImuStartStatus::in_motion;
  how.reason = StartedAfterGap{};
  how.accel_scale = before.accel_scale;
  how.gravity_map = known.gravity_map;
  how.gravity_sigma = 0.005;
  how.v_map_body = velocity_after(first.pose, last.pose, between, known.gravity_map);
  how.velocity_sigma = 0.03 / between.duration;
  how.bias = known.bias;
  how.bias_sigma.gyro.setConstant(0.005);
  how.bias_sigma.accel.setConstant(0.05);
  return {.state = {.stamp = last.stamp,
                    .T_map_body = last.pose,
                    .v_map_body = how.v_map_body,
                    .bias = how.bias,
                    .gravity_map = how.gravity_map,
                    .velocity = known.velocity},
          .how = how,
          .since = first.stamp};
}

Eigen::Vector3d velocity_after(const Eigen::Isometry3d& first, const Eigen::Isometry3d& second,
                               const Preintegration& between, const Eigen::Vector3d& gravity_map) {
  const double t = between.duration;
  const Eigen::Matrix3d& R = first.linear();
  const Eigen::Vector3d v_first =
      (second.translation() - first.translation() - R * between.increment.position) / t -
      0.5 * t * gravity_map;
  return v_first + t * gravity_map + R * between.increment.velocity;
}

}  // namespace adit
