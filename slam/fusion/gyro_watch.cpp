// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/gyro_watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "adit/slam/core/lie.hpp"

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
constexpr double kSigmasOfProven = 2.0;  // once clock or mounting were proven to be wrong
constexpr int kMostCorrections = 4;
// After a check that failed the sweeps are to tell what is wrong, without the sensor: for so many.
constexpr int kUnexplained = 50;
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

}  // namespace

std::optional<FrameCorrection> correction(const GyroCheck& check, const SensorFrame& frame,
                                          const CorrectionBounds& bounds) {
  const RotationComparison& found = *check.comparison;
  SensorFrame corrected = frame;
  std::optional<double> clock;
  std::optional<double> turned;
  const double late = found.offset - frame.clock_offset;
  if (bounds.clock && std::abs(late) > bounds.least_clock + bounds.sigmas * found.offset_sigma) {
    corrected.clock_offset = found.offset;
    clock = found.offset;
  }
  const Eigen::Vector3d turn =
      significant_turn(found, frame.T_body_lidar.linear().transpose(), bounds.sigmas);
  if (bounds.mounting && turn.norm() > 0.0) {
    // The mast stays as long as it is, and where it stands on the lidar.
    Eigen::Isometry3d T_lidar_body = frame.T_body_lidar.inverse();
    T_lidar_body.linear() = so3_exp(turn) * T_lidar_body.linear();
    corrected.T_body_lidar = T_lidar_body.inverse();
    turned = turn.norm();
  }
  if (!clock && !turned) {
    return std::nullopt;
  }
  return FrameCorrection{.what = {.check = check, .clock = clock, .turned = turned},
                         .frame = corrected};
}

GyroWatch::GyroWatch(const ImuConfig& config, double configured_offset)
    : refine_clock_(config.refine_time_offset),
      refine_mounting_(config.refine_rotation),
      configured_offset_(configured_offset) {}

void GyroWatch::note_sweep() {
  unexplained_ = std::max(0, unexplained_ - 1);
}

void GyroWatch::accuse() {
  unexplained_ = kUnexplained;
  monitor_.forget_turns();
}

void GyroWatch::forget() {
  monitor_.forget_turns();
  suspected_ = GyroFault::none;
}

std::optional<GyroVerdict> GyroWatch::check(const StampedPose& alignment,
                                            const SweepMotion* deskewed, const SensorFrame& frame,
                                            std::vector<Nanoseconds> saturated, bool timed) {
  monitor_.add(alignment, deskewed);
  const auto found =
      monitor_.check({.R_lidar_imu = frame.T_body_lidar.linear().transpose(),
                      .offset = frame.clock_offset,
                      .tolerance = timed ? kHarmlessOffset : kHarmlessOffset + kSweepPeriod,
                      .configured = configured_offset_,
                      .saturated = std::move(saturated)});
  if (!found) {
    return std::nullopt;
  }
  comparison_ = found->comparison ? found->comparison : comparison_;
  return judge(*found, frame, timed);
}

std::optional<GyroVerdict> GyroWatch::judge(const GyroCheck& check, const SensorFrame& frame,
                                            bool timed) {
  const bool fault = check.fault != GyroFault::none;
  const bool again = fault && check.fault == suspected_;
  suspected_ = check.fault;
  // A check failed, and the lidar has gone alone since: less than a fault is corrected, if it is
  // sure.
  const bool accused = std::exchange(unexplained_, 0) > 0;
  const bool of_frame = check.fault == GyroFault::clock || check.fault == GyroFault::mounting;
  if (check.comparison && (of_frame || !fault)) {
    const bool known = tells_mounting(*check.comparison);
    const bool corrected = (of_frame && known) || corrections_ > 0;
    const bool may = (corrected || accused) && corrections_ < kMostCorrections;
    const double sigmas = !may ? kSigmas : corrected ? kSigmasOfProven : kSureSigmas;
    const auto done = correction(check, frame,
                                 {.clock = may || refine_clock_,
                                  .mounting = known && (may || refine_mounting_),
                                  .least_clock = may && !timed ? kSweepPeriod : kLeastClock,
                                  .sigmas = sigmas});
    if (done) {
      corrections_ += may ? 1 : 0;
      trial_ = PredictsWorse{};
      suspected_ = GyroFault::none;
      monitor_.forget_turns();
      return *done;
    }
  }
  if (fault && !again) {
    // Sweeps that it de-skews and predicts take after it: the next are to tell without it.
    monitor_.forget_turns();
  }
  return fault ? std::optional<GyroVerdict>(GyroscopeDisagrees{.check = check, .refused = again})
               : std::nullopt;
}

std::optional<PredictsWorse> GyroWatch::note_prediction(bool better_turn) {
  if (!trial_) {
    return std::nullopt;
  }
  ++trial_->sweeps;
  trial_->better += better_turn ? 1 : 0;
  if (trial_->sweeps < kTrial) {
    return std::nullopt;
  }
  const PredictsWorse result = *std::exchange(trial_, std::nullopt);
  return kWorse * result.better < result.sweeps ? std::optional(result) : std::nullopt;
}

}  // namespace adit
