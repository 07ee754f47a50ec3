// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How InertialTracker comes to its start: what it is used for before, the sweeps it collects, and
// what it makes of them.
#include <algorithm>
#include <chrono>
#include <utility>

#include "adit/slam/fusion/inertial_tracker.hpp"
#include "adit/slam/inertial/imu_rest.hpp"

namespace adit {
namespace {

// A start: this much of aligned sweeps, which at rest moved less than ...
constexpr double kStartDuration = 1.0;  // s
constexpr size_t kStartPoses = 8;
constexpr size_t kMostPoses = 24;
constexpr double kRestDistance = 0.05;  // m
constexpr double kRestTurn = 0.02;      // rad
// The gyroscope is believed before that unless it turns this much otherwise than alignments.
constexpr double kTurnDisagreement = 0.1;  // rad
constexpr size_t kFewestQuiet = 5;         // readings between two sweeps
constexpr double kFastestTurn = 12.0;      // rad/s; readings beyond are not believed either

std::optional<InertialHindrance> hindrance_of(const std::optional<CoverageFault>& fault) {
  return fault ? std::visit([](const auto& one) { return std::optional<InertialHindrance>(one); },
                            *fault)
               : std::nullopt;
}

}  // namespace

std::optional<SweepMotion> InertialTracker::turning_motion(Nanoseconds stamp, double duration,
                                                           const Eigen::Vector3d& velocity) const {
  const Nanoseconds end =
      stamp + std::chrono::round<Nanoseconds>(std::chrono::duration<double>(duration));
  ImuInterval interval = buffer_.between(stamp, end);
  const auto too_fast = [](const ImuSample& sample) {
    return sample.angular_velocity.norm() > kFastestTurn;
  };
  if (state_ != InertialState::starting || !gyro_agrees_ || duration <= 0.0 ||
      complaint(interval) || std::ranges::any_of(interval.samples, too_fast)) {
    return std::nullopt;
  }
  for (ImuSample& sample : interval.samples) {
    sample.linear_acceleration.setZero();
  }
  NavState state;
  state.stamp = stamp;
  state.v_map_body = T_body_lidar_.linear() * velocity;
  state.gravity_map.setZero();
  return inertial_motion(state, interval.samples, T_body_lidar_, 0.0, duration);
}

std::optional<Eigen::Matrix3d> InertialTracker::turn(Nanoseconds begin, Nanoseconds end) const {
  const auto motion = turning_motion(begin, seconds(end - begin), Eigen::Vector3d::Zero());
  return motion ? std::optional<Eigen::Matrix3d>(motion->T_start_lidar.back().linear())
                : std::nullopt;
}

bool InertialTracker::is_quiet_between(Nanoseconds begin, Nanoseconds end) const {
  const ImuInterval interval = buffer_.between(begin, end);
  return state_ == InertialState::starting && interval.samples.size() >= kFewestQuiet &&
         !complaint(interval) && is_quiet(statistics_of(interval.samples));
}

void InertialTracker::collect(const StampedPose& T_map_lidar, bool aligned) {
  const StampedPose body{T_map_lidar.stamp, T_map_lidar.pose * T_body_lidar_.inverse()};
  if (aligned && !poses_.empty() && body.stamp > poses_.back().stamp) {
    ImuInterval interval = buffer_.between(poses_.back().stamp, body.stamp);
    if (const auto turned = turn(poses_.back().stamp, body.stamp)) {
      const Eigen::Matrix3d R_body_lidar = T_body_lidar_.linear();
      const Eigen::Matrix3d found = R_body_lidar.transpose() *
                                    poses_.back().pose.linear().transpose() * body.pose.linear() *
                                    R_body_lidar;
      gyro_agrees_ = rotation_angle(turned->transpose() * found) < kTurnDisagreement;
    }
    if (const auto stuck = stuck_.stuck()) {
      hindrance_ = *stuck;
    } else {
      hindrance_ = hindrance_of(complaint(interval));
    }
    if (!hindrance_) {
      readings_.push_back(std::move(interval.samples));
    } else {
      poses_.clear();
      readings_.clear();
    }
  } else {
    poses_.clear();
    readings_.clear();
  }
  if (aligned) {
    poses_.push_back(body);
  }
  while (poses_.size() > kMostPoses) {
    poses_.pop_front();
    readings_.pop_front();
  }
}

void InertialTracker::note_begin(const StampedPose& T_map_lidar) {
  if (state_ == InertialState::starting && poses_.empty()) {
    collect(T_map_lidar, true);
  }
}

void InertialTracker::try_start() {
  if (suspected_ != GyroFault::none || unexplained_ > 0 || poses_.size() < 2 ||
      (after_gap_ && start_again_after_gap())) {
    return;
  }
  const StampedPose& first = poses_.front();
  const StampedPose& last = poses_.back();
  if (poses_.size() < kStartPoses || seconds(last.stamp - first.stamp) < kStartDuration) {
    return;
  }
  const Eigen::Isometry3d moved = first.pose.inverse() * last.pose;
  ImuStart how;
  if (moved.translation().norm() < kRestDistance && rotation_angle(moved.linear()) < kRestTurn) {
    how = start_at_rest(buffer_.between(first.stamp, last.stamp).samples, noise_);
    how.gravity_map = kStandardGravity * (last.pose.linear() * -how.up_body);
  }
  // At rest with an implausible gravity: that no motion explains.
  if (!is_started(how.status) && how.status != ImuStartStatus::implausible) {
    const std::vector<StampedPose> poses(poses_.begin(), poses_.end());
    const std::vector<std::vector<ImuSample>> readings(readings_.begin(), readings_.end());
    how = start_in_motion(poses, readings, noise_);
  }
  const bool sign_assumed = rested_at_ && how.status == ImuStartStatus::in_motion;
  if (is_started(how.status) && last_fused_ && how.accel_scale != accel_scale_ &&
      !(sign_assumed && how.accel_scale == -accel_scale_)) {
    hindrance_ = UnitChanged{};
    return;
  }
  hindrance_ = how.reason;
  if (!is_started(how.status)) {
    return;
  }
  const NavState state{.stamp = last.stamp,
                       .T_map_body = last.pose,
                       .v_map_body = how.v_map_body,
                       .bias = how.bias,
                       .gravity_map = how.gravity_map};
  hindrance_.reset();
  if (how.status == ImuStartStatus::in_motion) {
    rested_at_.reset();
  } else if (!last_fused_) {
    rested_at_ = last.pose.translation();
  }
  if (const auto failed = failed_check({.state = state})) {
    lose(*failed);
    return;
  }
  start(state, how);
}

// Gravity, unit and biases are known; the velocity follows from the last two poses.
bool InertialTracker::start_again_after_gap() {
  const StampedPose& before = poses_[poses_.size() - 2];
  const StampedPose& last = poses_.back();
  const Preintegration between = preintegrate(scaled(readings_.back()), last_fused_->bias, noise_);
  const double t = between.duration;
  const Eigen::Matrix3d& R = before.pose.linear();
  const Eigen::Vector3d v_before =
      (last.pose.translation() - before.pose.translation() - R * between.increment.position) / t -
      0.5 * t * last_fused_->gravity_map;
  ImuStart how;
  how.status = ImuStartStatus::in_motion;
  how.reason = StartedAfterGap{};
  how.accel_scale = accel_scale_;
  how.gravity_map = last_fused_->gravity_map;
  how.gravity_sigma = 0.005;
  how.velocity_sigma = 0.03 / t;
  how.bias = last_fused_->bias;
  how.bias_sigma.gyro.setConstant(0.005);
  how.bias_sigma.accel.setConstant(0.05);
  start({.stamp = last.stamp,
         .T_map_body = last.pose,
         .v_map_body = v_before + t * last_fused_->gravity_map + R * between.increment.velocity,
         .bias = how.bias,
         .gravity_map = how.gravity_map},
        how);
  return true;
}

void InertialTracker::start(const NavState& state, const ImuStart& how) {
  accel_scale_ = how.accel_scale;
  graph_.emplace(GraphSettings{.noise = noise_,
                               .gravity_walk = config_.gravity_walk,
                               .lag = config_.lag,
                               .reset = config_.reset});
  StateVector sigma;
  sigma << Eigen::Vector3d::Constant(0.02), Eigen::Vector3d::Constant(0.005),
      Eigen::Vector3d::Constant(how.velocity_sigma), how.bias_sigma.gyro, how.bias_sigma.accel,
      Eigen::Vector2d::Constant(how.gravity_sigma);
  graph_->start(independent_prior(state, sigma));
  last_fused_ = state;
  state_ = InertialState::fused;
  event_ = InertialEvent{.cause = SensorStarted{.how = how.reason}};
  after_gap_ = false;
  poses_.clear();
  readings_.clear();
}

}  // namespace adit
