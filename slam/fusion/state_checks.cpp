// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/state_checks.hpp"

#include <cmath>

namespace adit {
namespace {

constexpr double kFastest = 100.0;         // m/s
constexpr double kUntimed = 1.0;           // m, in no time
constexpr double kHardest = 100.0;         // m/s², the mean from sweep to sweep
constexpr double kLargestGyroBias = 0.3;   // rad/s
constexpr double kLargestAccelBias = 3.0;  // m/s²

bool is_finite(const StateEstimate& estimate) {
  const NavState& nav = estimate.state;
  return nav.T_map_body.matrix().allFinite() && nav.v_map_body.allFinite() &&
         nav.bias.gyro.allFinite() && nav.bias.accel.allFinite() && nav.gravity_map.allFinite() &&
         estimate.covariance.allFinite();
}

}  // namespace

std::optional<ImpossibleState> impossible_motion(const NavState& from,
                                                 const StateEstimate& prediction) {
  if (!is_finite(prediction)) {
    return ImpossibleState{.quantity = StateQuantity::prediction};
  }
  const double elapsed = seconds(prediction.state.stamp - from.stamp);
  const double acceleration = (prediction.state.v_map_body - from.v_map_body).norm() / elapsed;
  if (acceleration <= kHardest) {
    return std::nullopt;
  }
  return ImpossibleState{
      .quantity = StateQuantity::acceleration, .value = acceleration, .limit = kHardest};
}

std::optional<ImpossibleState> impossible_state(const StateEstimate& estimate,
                                                const std::optional<NavState>& before) {
  const NavState& nav = estimate.state;
  if (!is_finite(estimate)) {
    return ImpossibleState{.quantity = StateQuantity::state};
  }
  if (const double speed = nav.v_map_body.norm(); speed > kFastest) {
    return ImpossibleState{.quantity = StateQuantity::speed, .value = speed, .limit = kFastest};
  }
  if (before) {
    const double moved = (nav.T_map_body.translation() - before->T_map_body.translation()).norm();
    const double elapsed = std::abs(seconds(nav.stamp - before->stamp));
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
  return std::nullopt;
}

}  // namespace adit
