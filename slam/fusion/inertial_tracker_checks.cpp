// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The checks of InertialTracker, each sweep, and what follows where one fails.
#include <algorithm>
#include <chrono>
#include <cmath>

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

std::optional<CoverageFault> InertialTracker::complaint(const ImuInterval& interval) const {
  if (interval.samples.empty()) {
    return NoReadings{};
  }
  // A gap is bridged between its ends; where one of them is missing, nothing tells what comes.
  const double most = config_.max_gap;
  const double held = std::max(interval.held_before, interval.held_after);
  if (interval.longest_gap <= most && held <= std::min(most, kReadingGap)) {
    return std::nullopt;
  }
  return GapTooLong{.gap = interval.longest_silence(), .limit = most};
}

void InertialTracker::lose(const FailedCheck& check) {
  losses_ += passing_cause() ? 0 : 1;  // else it is known why, and passes
  const bool again = losses_ >= kLosses;
  leave(again ? InertialState::refused : InertialState::lost,
        CheckFailed{.check = check, .losses = losses_, .refused = again});
}

std::optional<PassingCause> InertialTracker::passing_cause() const {
  const Nanoseconds newest = buffer_.empty() ? Nanoseconds(0) : buffer_.back().stamp;
  const auto saturated =
      buffer_.empty() ? std::nullopt : saturation_.between(newest - kToldAgain, newest);
  if (saturated) {
    return *saturated;
  }
  const bool bridged = graph_ && bridged_at_ && graph_->latest().stamp - *bridged_at_ < kGapTells;
  return bridged ? std::optional<PassingCause>(GapBridged{}) : std::nullopt;
}

void InertialTracker::leave(InertialState state, const InertialCause& why) {
  event_ = InertialEvent{.cause = why, .passing = passing_cause()};
  state_ = state;
  graph_.reset();
  pending_.reset();
  poses_.clear();
  readings_.clear();
  surprises_ = 0;
  fused_sweeps_ = 0;
  alone_since_ = 0.0;
}

// Held against what the sweeps left of the state before.
std::optional<ImpossibleState> InertialTracker::impossible_motion(
    const StateEstimate& prediction) const {
  const NavState& from = graph_->latest();
  const NavState& to = prediction.state;
  const double elapsed = seconds(to.stamp - from.stamp);
  if (!to.T_map_body.matrix().allFinite() || !to.v_map_body.allFinite() ||
      !prediction.covariance.allFinite()) {
    return ImpossibleState{.quantity = StateQuantity::prediction};
  }
  const double acceleration = (to.v_map_body - from.v_map_body).norm() / elapsed;
  if (acceleration <= kHardest) {
    return std::nullopt;
  }
  return ImpossibleState{
      .quantity = StateQuantity::acceleration, .value = acceleration, .limit = kHardest};
}

std::optional<FailedCheck> InertialTracker::failed_check(const StateEstimate& estimate) const {
  const NavState& nav = estimate.state;
  if (!nav.T_map_body.matrix().allFinite() || !nav.v_map_body.allFinite() ||
      !estimate.covariance.allFinite()) {
    return ImpossibleState{.quantity = StateQuantity::state};
  }
  if (const double speed = nav.v_map_body.norm(); speed > kFastest) {
    return ImpossibleState{.quantity = StateQuantity::speed, .value = speed, .limit = kFastest};
  }
  if (last_fused_ && graph_) {
    const double moved =
        (nav.T_map_body.translation() - last_fused_->T_map_body.translation()).norm();
    const double elapsed = std::abs(seconds(nav.stamp - last_fused_->stamp));
    const double most = kFastest * elapsed + kUntimed;
    if (moved > most) {
      return ImpossibleState{
          .quantity = StateQuantity::distance, .value = moved, .limit = most, .elapsed = elapsed};
    }
  }
  if (const double bias = nav.bias.gyro.norm(); bias > kLargestGyroBias) {
    return ImpossibleState{
        .quantity = StateQuantity::gyro_bias, .value = bias, .limit = kLargestGyroBias};
  }
  if (const double bias = nav.bias.accel.norm(); bias > kLargestAccelBias) {
    return ImpossibleState{
        .quantity = StateQuantity::accel_bias, .value = bias, .limit = kLargestAccelBias};
  }
  if (surprises_ >= kSurprises) {
    return AlignmentsContradict{
        .alignments = surprises_, .timed = timed_, .sign_assumed = rested_at_.has_value()};
  }
  if (alone_since_ > kLongestAlone) {
    return NotAligned{.duration = alone_since_, .limit = kLongestAlone};
  }
  return std::nullopt;
}

}  // namespace adit
