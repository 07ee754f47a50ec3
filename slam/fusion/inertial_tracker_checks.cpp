// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The checks of InertialTracker, each sweep, and what follows where one fails.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "adit/slam/core/text.hpp"
#include "adit/slam/fusion/inertial_tracker.hpp"

namespace adit {
namespace {

constexpr int kSurprises = 3;              // in a row are a failure
constexpr double kFastest = 100.0;         // m/s
constexpr double kUntimed = 1.0;           // m, in no time
constexpr double kHardest = 100.0;         // m/s², the mean from sweep to sweep
constexpr double kLargestGyroBias = 0.3;   // rad/s
constexpr double kLargestAccelBias = 3.0;  // m/s²
constexpr double kLongestAlone = 3.0;      // s by inertia alone
constexpr int kLosses = 5;                 // without a long time of fusion in between
// A gap that was bridged explains for this long what goes wrong.
constexpr Nanoseconds kGapTells = std::chrono::seconds(2);

}  // namespace

std::string InertialTracker::complaint(const ImuInterval& interval, double most) const {
  if (interval.samples.empty()) {
    return "there are no IMU readings";
  }
  // A gap is bridged between its ends; where one of them is missing, nothing tells what comes.
  const double held = std::max(interval.held_before, interval.held_after);
  const bool covered = interval.longest_gap <= most && held <= std::min(most, kReadingGap);
  const double longest = interval.longest_silence();
  return covered ? ""
                 : "no IMU readings for " + in_digits(longest) + " s (imu.max_gap is " +
                       in_digits(config_.max_gap) + ")";
}

void InertialTracker::lose(const std::string& why) {
  losses_ += passing_cause().empty() ? 1 : 0;  // else it is known why, and passes
  const bool again = losses_ >= kLosses;
  leave(again ? InertialState::refused : InertialState::lost,
        why + (again ? "; lost " + std::to_string(losses_) +
                           " times, so it is not used any more: check its mounting "
                           "(imu.T_imu_lidar), its clock and its units with adit inspect"
                     : ""));
}

std::string InertialTracker::recent_saturation() const {
  return buffer_.empty()
             ? ""
             : saturation_.evidence(buffer_.back().stamp - kToldAgain, buffer_.back().stamp);
}

std::string InertialTracker::passing_cause() const {
  const std::string saturated = recent_saturation();
  const bool bridged = graph_ && bridged_at_ && graph_->latest().stamp - *bridged_at_ < kGapTells;
  return !saturated.empty() || !bridged
             ? saturated
             : "readings were missing shortly before, and what they would have said was guessed";
}

void InertialTracker::leave(InertialState state, const std::string& why) {
  const std::string cause = passing_cause();
  state_ = state;
  event_ = why + (cause.empty() ? "" : "; " + cause);
  graph_.reset();
  pending_.reset();
  poses_.clear();
  readings_.clear();
  surprises_ = 0;
  fused_sweeps_ = 0;
  alone_since_ = 0.0;
}

// Held against what the sweeps left of the state before.
std::string InertialTracker::impossible_motion(const StateEstimate& prediction) const {
  const NavState& from = graph_->latest();
  const NavState& to = prediction.state;
  const double elapsed = seconds(to.stamp - from.stamp);
  if (!to.T_map_body.matrix().allFinite() || !to.v_map_body.allFinite() ||
      !prediction.covariance.allFinite()) {
    return "what the readings say of the motion is not finite";
  }
  const double acceleration = (to.v_map_body - from.v_map_body).norm() / elapsed;
  return acceleration <= kHardest
             ? ""
             : "the readings say that the sweep before was left with " + in_digits(acceleration) +
                   " m/s^2 on average, which nothing that carries a sensor does";
}

std::string InertialTracker::failed_check(const StateEstimate& estimate) const {
  const NavState& nav = estimate.state;
  if (!nav.T_map_body.matrix().allFinite() || !nav.v_map_body.allFinite() ||
      !estimate.covariance.allFinite()) {
    return "the fused state is not finite";
  }
  if (nav.v_map_body.norm() > kFastest) {
    return "the fused velocity is " + in_digits(nav.v_map_body.norm()) + " m/s";
  }
  if (last_fused_ && graph_) {
    const double moved =
        (nav.T_map_body.translation() - last_fused_->T_map_body.translation()).norm();
    const double elapsed = std::abs(seconds(nav.stamp - last_fused_->stamp));
    if (moved > kFastest * elapsed + kUntimed) {
      return "the fused position moved " + in_digits(moved) + " m in " + in_digits(elapsed) + " s";
    }
  }
  if (nav.bias.gyro.norm() > kLargestGyroBias) {
    return "the gyroscope's bias would be " + in_digits(nav.bias.gyro.norm()) +
           " rad/s: is it saturated, in degrees, or mounted otherwise than imu.T_imu_lidar says?";
  }
  if (nav.bias.accel.norm() > kLargestAccelBias) {
    return "the accelerometer's bias would be " + in_digits(nav.bias.accel.norm()) +
           " m/s^2: is its unit another, or imu.T_imu_lidar wrong?";
  }
  if (surprises_ >= kSurprises) {
    return std::to_string(surprises_) +
           " alignments in a row are where the IMU says that they cannot be" +
           (passing_cause().empty()
                ? (timed_ ? ": are clock and imu.T_imu_lidar right?"
                          : ": the sweeps have no times per point, so motion distorts them; else, "
                            "are clock and imu.T_imu_lidar right?")
                : "") +
           (rested_at_ && passing_cause().empty()
                ? " And the accelerometer's sign, which a start at rest cannot tell from a "
                  "sensor upside down?"
                : "");
  }
  return alone_since_ > kLongestAlone
             ? "no sweep could be aligned for " + in_digits(alone_since_) + " s"
             : "";
}

}  // namespace adit
