// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/state_checks.hpp"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "adit/tests/support/simulated_imu.hpp"

namespace adit {
namespace {

StateEstimate estimate(double time) {
  StateEstimate result;
  result.state.stamp = test::at_seconds(time);
  result.covariance.setIdentity();
  return result;
}

TEST(StateChecks, AMotionHasALargestAcceleration) {
  const NavState from = estimate(1.0).state;
  StateEstimate prediction = estimate(1.1);
  prediction.state.v_map_body.x() = 9.9;
  EXPECT_FALSE(impossible_motion(from, prediction));
  prediction.state.v_map_body.x() = 10.1;
  const auto found = impossible_motion(from, prediction);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->quantity, StateQuantity::acceleration);
  EXPECT_NEAR(found->value, 101.0, 1e-6);
  EXPECT_EQ(found->limit, 100.0);
}

TEST(StateChecks, BoundsOfAState) {
  struct Bound {
    StateQuantity quantity;
    double least;  ///< that cannot be, to four digits
    std::function<void(StateEstimate&, double)> set;
  };
  const Bound bounds[] = {
      {StateQuantity::speed, 100.0,
       [](StateEstimate& one, double value) { one.state.v_map_body.y() = value; }},
      {StateQuantity::distance, 11.0,
       [](StateEstimate& one, double value) { one.state.T_map_body.translation().z() = value; }},
      {StateQuantity::gyro_bias, 0.3,
       [](StateEstimate& one, double value) { one.state.bias.gyro.x() = value; }},
      {StateQuantity::accel_bias, 3.0,
       [](StateEstimate& one, double value) { one.state.bias.accel.y() = value; }}};
  for (const Bound& bound : bounds) {
    StateEstimate one = estimate(1.1);
    bound.set(one, 0.9999 * bound.least);
    EXPECT_FALSE(impossible_state(one, estimate(1.0).state)) << to_string(bound.quantity);
    bound.set(one, 1.0001 * bound.least);
    const auto found = impossible_state(one, estimate(1.0).state);
    ASSERT_TRUE(found) << to_string(bound.quantity);
    EXPECT_EQ(found->quantity, bound.quantity);
    EXPECT_NEAR(found->value, 1.0001 * bound.least, 1e-9);
    EXPECT_NEAR(found->limit, bound.least, 1e-9);
  }
}

TEST(StateChecks, AFirstStateMayBeAnywhere) {
  StateEstimate far = estimate(1.1);
  far.state.T_map_body.translation().x() = 1e4;
  EXPECT_FALSE(impossible_state(far, std::nullopt));
  EXPECT_NEAR(impossible_state(far, estimate(1.0).state)->elapsed, 0.1, 1e-9);
}

TEST(StateChecks, NothingOfAStateMayBeInfinite) {
  const std::function<void(StateEstimate&)> damages[] = {
      [](StateEstimate& one) { one.state.T_map_body.translation().x() = std::nan(""); },
      [](StateEstimate& one) { one.state.v_map_body.x() = std::nan(""); },
      [](StateEstimate& one) { one.state.bias.gyro.x() = std::nan(""); },
      [](StateEstimate& one) { one.state.bias.accel.x() = std::nan(""); },
      [](StateEstimate& one) { one.state.gravity_map.x() = std::nan(""); },
      [](StateEstimate& one) { one.covariance(3, 7) = INFINITY; }};
  for (const auto& damage : damages) {
    StateEstimate one = estimate(1.1);
    damage(one);
    const auto state = impossible_state(one, std::nullopt);
    ASSERT_TRUE(state);
    EXPECT_EQ(state->quantity, StateQuantity::state);
    const auto motion = impossible_motion(estimate(1.0).state, one);
    ASSERT_TRUE(motion);
    EXPECT_EQ(motion->quantity, StateQuantity::prediction);
  }
}

}  // namespace
}  // namespace adit
