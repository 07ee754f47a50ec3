// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How InertialTracker finds that clock or mounting are not what they are said to be, and corrects
// them where it may.
#include <array>
#include <chrono>
#include <cmath>
#include <utility>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/fusion/inertial_tracker.hpp"

namespace adit {
namespace {

// What sweeps can hide of a clock: their own distortion, or, without times of points, whether the
// stamp is a sweep's begin or its end.
constexpr double kHarmlessOffset = 0.02;  // s
constexpr double kSweepPeriod = 0.11;     // s
// Refinement: changes beyond so much, and so many standard deviations, are worth a new start. Less
// than that, sweeps feign: what they are de-skewed with shows in their turns, and a small
// correction would ask for the next.
constexpr double kLeastClock = 0.008;  // s
constexpr double kLeastTurn = 0.01;    // rad
constexpr double kSigmas = 3.0;
constexpr double kSigmasOfAccused = 2.0;  // where something is known to be wrong
constexpr double kFarOff = 0.35;          // rad
constexpr int kMostCorrections = 4;
// After a correction: better than constant velocity in one of so many, over so many sweeps. Sensors
// that are right are in 62 to 100 % of all.
constexpr int kWorse = 3;
constexpr int kTrial = 30;

/// From the mounting R_lidar_imu to the one that was found, about the lidar's axes: those of its
/// components that the motion tells apart from nothing, if one of them is worth it.
Eigen::Vector3d significant_turn(const RotationComparison& found, const Eigen::Matrix3d& R,
                                 double sigmas) {
  const Eigen::Vector3d turn = so3_log(found.R_range_gyro * R.transpose());
  const Eigen::Array3d beyond = turn.array().abs() - sigmas * found.mounting_sigma.array();
  if (!(beyond > kLeastTurn).any()) {
    return Eigen::Vector3d::Zero();
  }
  return (beyond > 0.0).select(turn.array(), 0.0);
}

/// Where the motion hides an axis, a sensor that is far off about the others may be so about that
/// one.
bool is_known(const RotationComparison& found, const Eigen::Matrix3d& R) {
  return found.mounting_sigma.allFinite() ||
         rotation_angle(found.R_range_gyro * R.transpose()) < kFarOff;
}

}  // namespace

void InertialTracker::watch(const StampedPose& alignment, const SweepMotion* deskewed) {
  if (state_ == InertialState::absent || state_ == InertialState::refused) {
    return;
  }
  monitor_.add(alignment, deskewed);
  GyroExpectation expected{.R_lidar_imu = R_lidar_body(),
                           .offset = clock_offset_,
                           .tolerance = timed_ ? kHarmlessOffset : kHarmlessOffset + kSweepPeriod,
                           .configured = configured_offset_,
                           .saturated = {}};
  const auto own_clock =
      std::chrono::round<Nanoseconds>(std::chrono::duration<double>(clock_offset_));
  for (const Nanoseconds stamp : saturation_.of_gyroscope()) {
    expected.saturated.push_back(stamp + own_clock);
  }
  if (const auto check = monitor_.check(expected)) {
    comparison_ = check->comparison ? check->comparison : comparison_;
    judge(*check);
  }
}

void InertialTracker::judge(const GyroCheck& check) {
  const bool fault = check.fault != GyroFault::none;
  const bool again = fault && check.fault == suspected_;
  suspected_ = check.fault;
  // After a check that failed less than a proof will do.
  const bool accused = std::exchange(unexplained_, 0) > 0;
  const bool of_frame = check.fault == GyroFault::clock || check.fault == GyroFault::mounting;
  if (check.comparison && (of_frame || !fault)) {
    const bool proven = of_frame && is_known(*check.comparison, R_lidar_body());
    const bool may = (proven || accused || corrections_ > 0) && corrections_ < kMostCorrections;
    const auto done = correct(check, {.clock = may || config_.refine_time_offset,
                                      .mounting = may || config_.refine_rotation,
                                      .least_clock = may && !timed_ ? kSweepPeriod : kLeastClock,
                                      .sigmas = may ? kSigmasOfAccused : kSigmas});
    if (done) {
      corrections_ += may ? 1 : 0;
      trial_ = Trial{};
      gyro_agrees_ = true;  // what was seen before was with the fault
      suspected_ = GyroFault::none;
      after_gap_ = false;
      monitor_.forget_turns();
      leave(InertialState::starting, *done);
      return;
    }
  }
  if (again) {
    leave(InertialState::refused, GyroscopeDisagrees{.check = check, .refused = true});
  } else if (fault) {
    // Sweeps that it de-skews and predicts take after it: the next are to tell without it.
    monitor_.forget_turns();
    leave(InertialState::lost, GyroscopeDisagrees{.check = check});
  }
}

void InertialTracker::try_out(const InertialReport& report) {
  if (!trial_ || !report.compared) {
    return;
  }
  ++trial_->sweeps;
  trial_->better += report.better_turn ? 1 : 0;
  if (trial_->sweeps < kTrial) {
    return;
  }
  if (kWorse * trial_->better < trial_->sweeps) {
    leave(InertialState::refused,
          PredictsWorse{.better = trial_->better, .sweeps = trial_->sweeps});
  }
  trial_.reset();
}

std::optional<SensorCorrected> InertialTracker::correct(const GyroCheck& check,
                                                        const Corrections& allowed) {
  const RotationComparison& found = *check.comparison;
  SensorCorrected done{.check = check};
  const double late = found.offset - clock_offset_;
  if (allowed.clock && std::abs(late) > allowed.least_clock + allowed.sigmas * found.offset_sigma) {
    clock_offset_ = found.offset;
    const auto by = -std::chrono::round<Nanoseconds>(std::chrono::duration<double>(late));
    buffer_.shift(by);
    saturation_.shift(by);
    done.clock = clock_offset_;
  }
  const Eigen::Vector3d turn = significant_turn(found, R_lidar_body(), allowed.sigmas);
  if (allowed.mounting && turn.norm() > 0.0) {
    // The mast stays as long as it is, and where it stands on the lidar.
    Eigen::Isometry3d T_lidar_body = T_body_lidar_.inverse();
    T_lidar_body.linear() = so3_exp(turn) * T_lidar_body.linear();
    T_body_lidar_ = T_lidar_body.inverse();
    done.turned = turn.norm();
  }
  return done.clock || done.turned ? std::optional(done) : std::nullopt;
}

}  // namespace adit
