// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How InertialTracker comes to its start: what it is used for before, and the sweeps it collects.
#include <algorithm>
#include <chrono>
#include <utility>

#include <Eigen/Eigenvalues>

#include "adit/slam/fusion/inertial_tracker.hpp"
#include "adit/slam/fusion/state_checks.hpp"
#include "adit/slam/inertial/imu_rest.hpp"

namespace adit {
namespace {

// The gyroscope is trusted before a start unless it turns this much otherwise than alignments.
constexpr double kTurnDisagreement = 0.1;  // rad
constexpr size_t kFewestQuiet = 5;         // readings between two sweeps
constexpr double kFastestTurn = 12.0;      // rad/s; readings beyond are outliers as well

double square(double value) {
  return value * value;
}

}  // namespace

std::optional<Eigen::Matrix3d> InertialTracker::level_lidar(Nanoseconds begin,
                                                            Nanoseconds end) const {
  const ImuInterval interval = readings_.between(begin, end);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const ImuSample& sample : interval.samples) {
    sum += sample.linear_acceleration;
  }
  if (is<Absent>() || fault_of(interval) || !(sum.norm() > 0.0)) {
    return std::nullopt;
  }
  return level_attitude(T_body_lidar_.linear().transpose() * sum);
}

bool InertialTracker::is_quiet_between(Nanoseconds begin, Nanoseconds end) const {
  const ImuInterval interval = readings_.between(begin, end);
  return is<Starting>() && interval.samples.size() >= kFewestQuiet && !fault_of(interval) &&
         is_quiet(statistics_of(interval.samples));
}

std::optional<SweepMotion> InertialTracker::turning_motion(Nanoseconds stamp, double duration,
                                                           const Eigen::Vector3d& velocity) const {
  const auto* starting = std::get_if<Starting>(&state_);
  if (starting == nullptr || !starting->gyro_agrees || duration <= 0.0) {
    return std::nullopt;
  }
  ImuInterval interval = readings_.between(stamp, stamp + nanoseconds(duration));
  const auto too_fast = [](const ImuSample& sample) {
    return sample.angular_velocity.norm() > kFastestTurn;
  };
  if (fault_of(interval) || std::ranges::any_of(interval.samples, too_fast)) {
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

std::optional<MeasuredMotion> InertialTracker::measured_motion(Nanoseconds begin,
                                                               Nanoseconds end) const {
  const auto turned = turn(begin, end);
  if (!turned || !std::get<Starting>(state_).velocities_agree) {
    return std::nullopt;
  }
  NavState from;
  from.stamp = begin;
  const Eigen::Matrix3d R_body_lidar = T_body_lidar_.linear();
  const Eigen::Matrix3d R_end_body = (R_body_lidar * *turned).transpose();
  Eigen::Isometry3d T_body = Eigen::Isometry3d::Identity();
  T_body.linear() = R_body_lidar * *turned * R_body_lidar.transpose();
  std::vector<MeasuredDisplacement> ways = ways_until(end, from);
  std::ranges::reverse(ways);  // Doppler speeds first: they have no scale
  for (const MeasuredDisplacement& way : ways) {
    T_body.translation() = way.way + way.p_body_sensor - T_body.linear() * way.p_body_sensor;
    Eigen::Matrix3d errors = way.covariance;
    if (way.source == VelocitySource::sensor) {
      errors += square(velocity_.scale_sigma) * way.way * way.way.transpose() +
                square(velocity_.turn_sigma) * way.by_turn * way.by_turn.transpose();
    }
    const double largest = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(errors).eigenvalues()[2];
    if (largest > square(kTrustedPosition)) {
      continue;
    }
    MeasuredMotion motion{.T_begin_end = T_body_lidar_.inverse() * T_body * T_body_lidar_};
    motion.covariance.topLeftCorner<3, 3>() = R_end_body * errors * R_end_body.transpose();
    motion.covariance.bottomRightCorner<3, 3>() =
        Prediction{}.sigma.tail<3>().cwiseAbs2().asDiagonal();
    return motion;
  }
  return std::nullopt;
}

/// What measures another body's velocity must not lead this one's first sweeps.
void InertialTracker::compare_velocities(Nanoseconds stamp, const RegistrationResult& alignment) {
  auto* starting = std::get_if<Starting>(&state_);
  if (starting == nullptr || starting->collected.poses().empty()) {
    return;
  }
  const StampedPose& before = starting->collected.poses().back();
  if (const auto measured = measured_motion(before.stamp, stamp)) {
    const Eigen::Isometry3d T_map_lidar = before.pose * T_body_lidar_ * measured->T_begin_end;
    starting->velocities_agree = !is_outlier(T_map_lidar, measured->covariance, alignment);
  }
}

void InertialTracker::collect(const StampedPose& T_map_lidar, std::vector<Eigen::Vector3d> unheld) {
  StartCollection& waiting = *collected();
  const StampedPose body{T_map_lidar.stamp, T_map_lidar.pose * T_body_lidar_.inverse()};
  std::optional<std::vector<ImuSample>> since;
  if (!waiting.poses().empty() && body.stamp > waiting.poses().back().stamp) {
    const StampedPose& before = waiting.poses().back();
    ImuInterval interval = readings_.between(before.stamp, body.stamp);
    if (const auto turned = turn(before.stamp, body.stamp)) {
      const Eigen::Matrix3d R_body_lidar = T_body_lidar_.linear();
      const Eigen::Matrix3d found = R_body_lidar.transpose() * before.pose.linear().transpose() *
                                    body.pose.linear() * R_body_lidar;
      std::get<Starting>(state_).gyro_agrees =
          rotation_angle(turned->transpose() * found) < kTurnDisagreement;
    }
    hindrance_.reset();
    if (const auto stuck = stuck_axis()) {
      hindrance_ = *stuck;
    } else if (const auto fault = fault_of(interval)) {
      std::visit([this](const auto& one) { hindrance_ = one; }, *fault);
    } else {
      since = std::move(interval.samples);
    }
  }
  waiting.add(body, std::move(since), std::move(unheld));
}

void InertialTracker::note_begin(const StampedPose& T_map_lidar) {
  if (is<Starting>() && collected()->poses().empty()) {
    collect(T_map_lidar, {});
  }
}

void InertialTracker::note_restart() {
  if (StartCollection* const waiting = collected()) {
    waiting->clear();
  }
  watch_.broken();
  if (auto* lost = std::get_if<Lost>(&state_)) {
    lost->after_gap = false;
  }
}

void InertialTracker::start_if_possible() {
  const StartCollection& waiting = *collected();
  if (watch_.is_pending()) {
    return;
  }
  if (!hindrance_ || std::holds_alternative<FewAligned>(*hindrance_)) {
    hindrance_ = few_aligned(waiting);
  }
  if (waiting.poses().size() < 2) {
    return;
  }
  const std::optional<FusedBefore> before =
      history_.fused ? std::optional(FusedBefore{.state = *history_.fused,
                                                 .accel_scale = history_.accel_scale,
                                                 .sign_assumed = history_.is_sign_assumed()})
                     : std::nullopt;
  if (const auto* lost = std::get_if<Lost>(&state_); lost != nullptr && lost->after_gap) {
    start(start_after_gap(waiting, noise_, *before));
    return;
  }
  const StartAttempt attempt = try_start(waiting, readings_, noise_, before);
  if (const auto* hindrance = std::get_if<InertialHindrance>(&attempt)) {
    hindrance_ = *hindrance;
  }
  const auto* found = std::get_if<SensorStart>(&attempt);
  if (found == nullptr) {
    return;
  }
  if (found->how.status == ImuStartStatus::in_motion) {
    history_.moved_unclearly = !is_sign_told(found->how) && (!before || before->sign_assumed);
    history_.rested_at.reset();
  } else if (!before) {
    history_.rested_at = found->state.T_map_body.translation();
  }
  if (const auto failed = impossible_state({.state = found->state}, std::nullopt)) {
    lose(*failed);
    return;
  }
  start(*found);
}

void InertialTracker::start(const SensorStart& start) {
  hindrance_.reset();
  event_ = InertialEvent{.cause = SensorStarted{.how = start.how.reason, .since = start.since}};
  history_.accel_scale = start.how.accel_scale;
  history_.fused = start.state;
  history_.failed_at.reset();
  state_ = Fused{
      .motion = FusedMotion({.noise = noise_,
                             .gravity_walk = config_.gravity_walk,
                             .gravity_walk_way = config_.gravity_walk_way,
                             .lag = config_.lag,
                             .reset = config_.reset},
                            start, {.scale = velocity_.scale_sigma, .turn = velocity_.turn_sigma})};
}

}  // namespace adit
