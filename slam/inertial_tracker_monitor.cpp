// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How InertialTracker finds that clock or mounting are not what they are said to be, and corrects
// them where it may.
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include "slam/inertial_tracker.hpp"
#include "slam/lie.hpp"

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

std::string text_of(double value, int digits) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 std::chars_format::fixed, digits);
  return {buffer.data(), end.ptr};
}

/// From the mounting R_lidar_imu to the one that was found, about the lidar's axes: those of its
/// components that the motion tells apart from nothing.
Eigen::Vector3d significant_turn(const RotationComparison& found, const Eigen::Matrix3d& R) {
  Eigen::Vector3d turn = so3_log(found.R_range_gyro * R.transpose());
  for (int i = 0; i < 3; ++i) {
    const double bound = kLeastTurn + kSigmas * found.mounting_sigma(i);
    turn(i) = std::abs(turn(i)) > bound ? turn(i) : 0.0;
  }
  return turn;
}

}  // namespace

void InertialTracker::watch(const StampedPose& T_map_lidar, bool aligned) {
  if (state_ == InertialState::absent || state_ == InertialState::refused) {
    return;
  }
  if (!aligned) {
    monitor_.broken();
    return;
  }
  monitor_.add(T_map_lidar);
  const auto check =
      monitor_.check({.R_lidar_imu = T_body_lidar_.linear().transpose(),
                      .offset = clock_offset_,
                      .tolerance = timed_ ? kHarmlessOffset : kHarmlessOffset + kSweepPeriod});
  if (!check) {
    return;
  }
  comparison_ = check->comparison ? check->comparison : comparison_;
  const bool consistent = check->fault == GyroFault::none || check->fault == GyroFault::clock ||
                          check->fault == GyroFault::mounting;
  if (check->comparison && consistent && refine(*check->comparison)) {
    suspected_ = GyroFault::none;
    return;
  }
  if (check->fault != GyroFault::none && check->fault == suspected_) {
    leave(InertialState::refused, check->evidence + "; it is not used any more");
  } else if (check->fault != GyroFault::none) {
    // Sweeps that it de-skews and predicts take after it: the next are to tell without it.
    leave(InertialState::lost, check->evidence + "; the lidar goes alone until that is clear");
  }
  suspected_ = check->fault;
}

bool InertialTracker::refine(const RotationComparison& found) {
  const double late = found.offset - clock_offset_;
  std::string what;
  if (config_.refine_time_offset != 0 &&
      std::abs(late) > kLeastClock + kSigmas * found.offset_sigma) {
    clock_offset_ = found.offset;
    buffer_.shift(-std::chrono::round<Nanoseconds>(std::chrono::duration<double>(late)));
    what = "its clock is corrected by " + text_of(-1e3 * clock_offset_, 1) + " ms";
  }
  const Eigen::Vector3d turn = significant_turn(found, T_body_lidar_.linear().transpose());
  if (config_.refine_rotation != 0 && turn.norm() > 0.0) {
    T_body_lidar_.linear() = T_body_lidar_.linear() * so3_exp(-turn);
    const std::string hidden = unobserved_axes(found);
    what += (what.empty() ? "" : ", ") + std::string("its mounting is turned by ") +
            text_of(turn.norm() * 180.0 / std::numbers::pi, 2) + " degrees" +
            (hidden.empty() ? "" : " (the motion does not tell " + hidden + ")");
  }
  if (what.empty()) {
    return false;
  }
  after_gap_ = false;
  leave(InertialState::lost, what + ", as the sweeps' turns say; starting anew");
  return true;
}

}  // namespace adit
