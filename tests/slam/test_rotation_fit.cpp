// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/rotation_fit.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/inertial/gyro_monitor.hpp"
#include "adit/tests/support/simulated_imu.hpp"

namespace adit {
namespace {

using test::at_seconds;

constexpr double kDuration = 8.0;  // s
const Eigen::Vector3d kFittedBias(0.02, -0.01, 0.015);

/// What the gyroscope reads of a motion, with a clock that is late by `offset` (s).
std::vector<ImuSample> gyroscope(const test::WavyMotion& motion, double offset) {
  std::vector<ImuSample> samples =
      test::readings(motion, -1.0, kDuration + 1.0, 200.0, {.gyro = kFittedBias});
  for (ImuSample& sample : samples) {
    sample.stamp += at_seconds(offset);
  }
  return samples;
}

/// Attitudes a tenth of a second apart, seen from axes R_range_body, with noise (rad).
std::vector<MeasuredTurn> turns(const test::WavyMotion& motion, const Eigen::Matrix3d& R_range_body,
                                double sigma, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, sigma);
  std::vector<MeasuredTurn> result;
  for (int i = 0; 0.1 * (i + 1) < kDuration; ++i) {
    const Eigen::Matrix3d R = motion.state(0.1 * i).T_map_body.linear().transpose() *
                              motion.state(0.1 * (i + 1)).T_map_body.linear();
    const Eigen::Vector3d error = Eigen::Vector3d::NullaryExpr([&] { return normal(random); });
    result.push_back(
        {.begin = 0.1 * i, .end = 0.1 * (i + 1), .rotation = R_range_body * so3_log(R) + error});
  }
  return result;
}

TEST(RotationFit, JacobiansAreThoseOfNumericalDifferentiation) {
  const GyroscopeIntegral integral(gyroscope(test::hand_held_motion(), 0.0), Nanoseconds(0));
  for (const double span : {0.0, 0.1}) {
    const MeasuredTurn turn{
        .begin = 2.003, .end = 2.104, .span = span, .rotation = {0.1, -0.2, 0.05}};
    const GyroscopeFrame frame{
        .offset = 0.0312, .R_range_gyro = so3_exp({0.3, -1.0, 0.7}), .bias = {0.01, 0.02, -0.03}};
    const TurnJacobian jacobian = linearized(turn, integral, frame).jacobian;
    constexpr double kStep = 1e-5;
    for (int i = 0; i < 7; ++i) {
      const auto residual = [&](double by) {
        GyroscopeFrame moved = frame;
        moved.offset += i == 0 ? by : 0.0;
        Eigen::Vector3d phi = Eigen::Vector3d::Zero();
        if (i >= 4) {
          moved.bias(i - 4) += by;
        } else if (i >= 1) {
          phi(i - 1) = by;
        }
        moved.R_range_gyro = so3_exp(phi) * moved.R_range_gyro;
        return linearized(turn, integral, moved).residual;
      };
      const Eigen::Vector3d numeric = (residual(kStep) - residual(-kStep)) / (2.0 * kStep);
      EXPECT_LE((numeric - jacobian.col(i)).norm(), 1e-6 * jacobian.norm()) << i << ", " << span;
    }
  }
}

TEST(RotationFit, ClockAndMountingAreToldApart) {
  const test::WavyMotion motion = test::hand_held_motion();
  const Eigen::Matrix3d R = so3_exp({0.03, -0.03, 0.03});  // 3 degrees
  const GyroscopeIntegral integral(gyroscope(motion, 0.03), Nanoseconds(0));
  double clock = 0.0;
  double mounting = 0.0;
  constexpr int kRuns = 30;
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    const RotationFit fit = fit_rotations(turns(motion, R, 0.002, seed), integral, {}, 0.3);
    EXPECT_NEAR(fit.frame.offset, 0.03, 0.003);
    const Eigen::Vector3d error = so3_log(fit.frame.R_range_gyro * R.transpose());
    EXPECT_LE(error.norm(), 0.01);
    clock += std::pow((fit.frame.offset - 0.03) / fit.offset_sigma, 2);
    mounting += (fit.axes.transpose() * error).cwiseAbs2().dot(fit.eigenvalues);
    EXPECT_EQ(fit.observable, (std::array{true, true, true}));
  }
  EXPECT_NEAR(clock / kRuns, 1.0, 0.8);             // chi squared of 1, 30 runs: 0.56 to 1.6
  EXPECT_NEAR(mounting / (3.0 * kRuns), 1.0, 0.6);  // chi squared of 3
}

TEST(RotationFit, AVehicleInThePlaneDoesNotTellTheHeadingOfTheMounting) {
  const test::WavyMotion planar{.position = {}, .angles = {{{}, {}, {0.5, 0.3, 0.0, 0.1}}}};
  const GyroscopeIntegral integral(gyroscope(planar, 0.02), Nanoseconds(0));
  const Eigen::Matrix3d yawed = so3_exp({0.0, 0.0, 0.4});
  const RotationFit fit = fit_rotations(turns(planar, so3_exp({0.05, 0.0, 0.0}), 0.0005, 1),
                                        integral, {.R_range_gyro = yawed}, 0.3);
  EXPECT_EQ(fit.observable, (std::array{false, true, true}));
  EXPECT_GE(std::abs(fit.axes.col(0).z()), 0.99);
  EXPECT_LE(fit.eigenvalues(0), 1e-3 * fit.eigenvalues(1));
  EXPECT_NEAR(fit.frame.offset, 0.02, 0.003);
  // About z it stays as it was, about the others it is found.
  const Eigen::Vector3d up = fit.frame.R_range_gyro * Eigen::Vector3d::UnitZ();
  EXPECT_LE((up - so3_exp({0.05, 0.0, 0.0}) * Eigen::Vector3d::UnitZ()).norm(), 0.005);
  EXPECT_NEAR(so3_log(fit.frame.R_range_gyro).z(), 0.4, 0.02);
}

/// The mean attitude over a tenth of a second, as rotation vector from its begin.
Eigen::Vector3d mean_over_sweep(const test::WavyMotion& motion, double time) {
  const Eigen::Matrix3d R = motion.state(time).T_map_body.linear();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < 100; ++i) {
    sum += so3_log(R.transpose() * motion.state(time + 1e-3 * (i + 0.5)).T_map_body.linear());
  }
  return sum / 100.0;
}

// Sweeps that were de-skewed with what is wrong are bent, and their attitude is off: but not the
// mean of what they went through.
TEST(GyroMonitor, WhatASweepWasDeskewedWithDoesNotShowInTheClock) {
  const test::WavyMotion motion = test::hand_held_motion();
  for (const double late : {0.05, -0.1}) {
    GyroMonitor knowing;
    GyroMonitor ignorant;
    for (const ImuSample& sample : gyroscope(motion, late)) {
      knowing.add(sample);
      ignorant.add(sample);
    }
    std::optional<GyroCheck> known;
    std::optional<GyroCheck> ignored;
    for (int i = 1; i < 60; ++i) {
      const double time = 0.1 * i;
      // As at constant velocity: the turn of the sweep before.
      const Eigen::Vector3d rate =
          10.0 * so3_log(motion.state(time - 0.1).T_map_body.linear().transpose() *
                         motion.state(time).T_map_body.linear());
      Vector6d twist;
      twist << Eigen::Vector3d::Zero(), rate;
      const SweepMotion used = steady_motion(twist, 0.0, 0.1);
      StampedPose aligned{at_seconds(time), motion.state(time).T_map_body};
      aligned.pose.linear() = aligned.pose.linear() * so3_exp(mean_over_sweep(motion, time)) *
                              so3_exp(-mean_turn(used));
      knowing.add(aligned, &used);
      ignorant.add(aligned);
      if (const auto check = knowing.check({})) {
        known = check;
      }
      if (const auto check = ignorant.check({})) {
        ignored = check;
      }
    }
    ASSERT_TRUE(known && known->comparison && ignored && ignored->comparison);
    EXPECT_NEAR(known->comparison->offset, late, 0.003);
    EXPECT_EQ(known->fault, GyroFault::clock);
    EXPECT_LE(known->comparison->misalignment, 0.01);
    EXPECT_GE(std::abs(ignored->comparison->offset - late), 0.01);
  }
}

/// Three seconds of sweeps, and what is said of a gyroscope that reads from `begin` (s) on.
GyroCheck check_of(std::vector<ImuSample> samples, double begin, const GyroExpectation& expected) {
  GyroMonitor monitor;
  for (const ImuSample& sample : samples) {
    if (sample.stamp >= at_seconds(begin)) {
      monitor.add(sample);
    }
  }
  for (int i = 0; i <= 30; ++i) {
    monitor.add({at_seconds(0.1 * i), test::hand_held_motion().state(0.1 * i).T_map_body});
  }
  return monitor.check(expected).value();
}

TEST(GyroMonitor, TurnsBeforeTheFirstReadingDoNotCount) {
  const std::vector<ImuSample> samples = gyroscope(test::hand_held_motion(), 0.0);
  EXPECT_TRUE(check_of(samples, 0.2, {}).comparison);
  const GyroCheck late = check_of(samples, 1.5, {});
  EXPECT_EQ(late.fault, GyroFault::none) << to_string(late.fault);
  EXPECT_FALSE(late.comparison);
}

TEST(GyroMonitor, TurnsNearSaturatedReadingsDoNotCount) {
  std::vector<ImuSample> samples = gyroscope(test::hand_held_motion(), 0.0);
  GyroExpectation expected;
  for (ImuSample& sample : samples) {
    if (sample.stamp > at_seconds(1.0) && sample.stamp < at_seconds(1.4)) {
      sample.angular_velocity.setConstant(20.0);
      expected.saturated.push_back(sample.stamp);
    }
  }
  EXPECT_EQ(check_of(samples, -1.0, {}).fault, GyroFault::unrelated);
  const GyroCheck check = check_of(samples, -1.0, expected);
  EXPECT_EQ(check.fault, GyroFault::none) << to_string(check.fault);
  ASSERT_TRUE(check.comparison);
  EXPECT_NEAR(check.comparison->offset, 0.0, 0.003);
}

/// What of 0 to 1 is done of something that swells and fades from `begin` (s) on, in `duration`.
double swollen(double time, double begin, double duration) {
  const double phase = std::clamp((time - begin) / duration, 0.0, 1.0);
  return phase - std::sin(2.0 * M_PI * phase) / (2.0 * M_PI);
}

// A blow that sweeps and gyroscope feel at different times, in three turns; the motion is in
// fifteen others.
TEST(GyroMonitor, AFewTurnsDoNotMoveTheClock) {
  const auto yaw = [](double time, double blow) {
    return 0.03 * swollen(time, blow, 0.2) + 0.19 * swollen(time, 1.0, 1.5);
  };
  GyroMonitor monitor;
  for (double time = -1.0; time < 4.0; time += 0.005) {
    const double rate = (yaw(time + 1e-4, 0.2) - yaw(time - 1e-4, 0.2)) / 2e-4;
    monitor.add({at_seconds(time), Eigen::Vector3d(0.0, 0.0, rate), Eigen::Vector3d::Zero()});
  }
  for (int i = 0; i <= 30; ++i) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = so3_exp({0.0, 0.0, yaw(0.1 * i, 0.25)});
    monitor.add({at_seconds(0.1 * i), pose});
  }
  GyroExpectation expected;
  expected.tolerance = 0.02;
  const GyroCheck check = monitor.check(expected).value();
  EXPECT_EQ(check.fault, GyroFault::none) << to_string(check.fault);
  ASSERT_TRUE(check.comparison);
  EXPECT_NEAR(check.comparison->offset, 0.0, 0.01);
}

TEST(RotationComparison, AScaleIsOffWhereAllTurnsSaySo) {
  EXPECT_FALSE(is_off_scale({.correlation = 0.999, .scale = 1.02, .scale_sigma = 0.004}));
  EXPECT_TRUE(is_off_scale({.correlation = 0.995, .scale = 1.1, .scale_sigma = 0.009}));
  EXPECT_TRUE(is_off_scale({.correlation = 0.995, .scale = 0.9, .scale_sigma = 0.009}));
  EXPECT_FALSE(is_off_scale({.correlation = 0.983, .scale = 1.13, .scale_sigma = 0.02}))
      << "sweeps of a wild motion tell no scale";
  EXPECT_FALSE(is_off_scale({.correlation = 0.995, .scale = 1.1, .scale_sigma = 0.02}));
}

TEST(GyroMonitor, AClockIsFoundWithWhatIsConfiguredOfItAlready) {
  GyroExpectation expected;
  expected.configured = 0.25;
  const GyroCheck check = check_of(gyroscope(test::hand_held_motion(), 0.1), -1.0, expected);
  EXPECT_EQ(check.fault, GyroFault::clock);
  EXPECT_EQ(check.configured_offset, 0.25);
  EXPECT_EQ(check.turns, 30U);
  ASSERT_TRUE(check.comparison);
  EXPECT_NEAR(check.comparison->offset, 0.1, 0.003);
}

}  // namespace
}  // namespace adit
