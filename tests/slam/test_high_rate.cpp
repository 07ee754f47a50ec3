// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/high_rate.hpp"

#include <chrono>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "adit/tests/support/simulated_imu.hpp"

namespace adit {
namespace {

constexpr ImuNoise kStreamNoise{.gyro = 1e-3, .accel = 1e-2, .gyro_walk = 1e-5, .accel_walk = 1e-4};
const ImuBias kStreamBias{{0.01, -0.02, 0.03}, {0.1, -0.05, 0.02}};

StateVector sigma() {
  StateVector sigma;
  sigma << Eigen::Vector3d::Constant(0.01), Eigen::Vector3d::Constant(0.002),
      Eigen::Vector3d::Constant(0.03), Eigen::Vector3d::Constant(0.002),
      Eigen::Vector3d::Constant(0.03), Eigen::Vector2d::Constant(0.01),
      Eigen::Vector3d::Constant(0.05);
  return sigma;
}

StateEstimate estimate_at(const test::WavyMotion& motion, double time,
                          const StateVector& error = StateVector::Zero()) {
  NavState state = motion.state(time);
  state.bias = kStreamBias;
  return {.state = retract(state, error), .covariance = sigma().cwiseAbs2().asDiagonal()};
}

TEST(HighRate, FollowsTheMotionBetweenEstimates) {
  const test::WavyMotion motion = test::hand_held_motion();
  HighRateOdometry odometry(kStreamNoise, 0.0);
  const auto samples = test::readings(motion, 0.0, 1.0, 1000.0, kStreamBias);
  int given = 0;
  Nanoseconds last = Nanoseconds::min();
  for (size_t i = 0; i < samples.size(); ++i) {
    // An estimate of 0, 100, ... ms, 40 ms late.
    if (i >= 40 && (i - 40) % 100 == 0) {
      odometry.correct(estimate_at(motion, static_cast<double>(i - 40) * 1e-3));
    }
    const auto state = odometry.add(samples[i]);
    EXPECT_EQ(state.has_value(), i >= 40);
    if (!state) {
      continue;
    }
    ++given;
    EXPECT_GT(state->nav.stamp, last);
    last = state->nav.stamp;
    EXPECT_EQ(state->nav.stamp, samples[i].stamp);
    NavState truth = motion.state(static_cast<double>(i) * 1e-3);
    truth.bias = kStreamBias;
    EXPECT_LE(difference(truth, state->nav).norm(), 2e-4) << i;
    EXPECT_LE(
        (state->angular_velocity - motion.sample(static_cast<double>(i) * 1e-3).angular_velocity)
            .norm(),
        1e-9);
  }
  EXPECT_EQ(given, 961);
}

TEST(HighRate, StampsThatDoNotRiseGiveNothing) {
  const test::WavyMotion motion = test::hand_held_motion();
  HighRateOdometry odometry(kStreamNoise, 0.0);
  odometry.correct(estimate_at(motion, 0.0));
  EXPECT_TRUE(odometry.add(motion.sample(0.0)));
  EXPECT_TRUE(odometry.add(motion.sample(0.01)));
  EXPECT_FALSE(odometry.add(motion.sample(0.01)));
  EXPECT_FALSE(odometry.add(motion.sample(0.005)));
  EXPECT_TRUE(odometry.add(motion.sample(0.02)));
}

TEST(HighRate, ItsCovarianceIsThatOfManyRuns) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const test::WavyMotion motion = test::hand_held_motion();
  const auto clean = test::readings(motion, 0.3, 0.6, 200.0, kStreamBias);
  const int runs = 600;
  double nees = 0.0;
  for (int run = 0; run < runs; ++run) {
    auto samples = clean;
    test::add_noise(samples, kStreamNoise, 200.0, random);
    const StateVector error =
        sigma().cwiseProduct(StateVector::NullaryExpr([&] { return normal(random); }));
    HighRateOdometry odometry(kStreamNoise, 0.0);
    odometry.correct(estimate_at(motion, 0.3, error));
    std::optional<HighRateState> last;
    for (const ImuSample& sample : samples) {
      last = odometry.add(sample);
    }
    NavState truth = motion.state(0.6);
    truth.bias = kStreamBias;
    const StateVector off = difference(truth, last->nav);
    nees += off.dot(last->covariance.ldlt().solve(off)) / runs;
  }
  RecordProperty("nees", std::to_string(nees));
  EXPECT_NEAR(nees, kStateSize, 3.0 * std::sqrt(2.0 * kStateSize / runs) + 0.2);
}

TEST(HighRate, SmoothingSpreadsACorrectionAndEndsAtIt) {
  const test::WavyMotion motion = test::hand_held_motion();
  const auto samples = test::readings(motion, 0.0, 0.3, 200.0, kStreamBias);
  const auto largest_step = [&](double smoothing) {
    HighRateOdometry odometry(kStreamNoise, smoothing);
    StateVector error = StateVector::Zero();
    error[0] = 0.05;
    odometry.correct(estimate_at(motion, 0.0, error));
    double largest = 0.0;
    double end = 0.0;
    Eigen::Vector3d before = Eigen::Vector3d::Zero();
    for (const ImuSample& sample : samples) {
      if (sample.stamp == test::at_seconds(0.15)) {
        odometry.correct(estimate_at(motion, 0.1));
      }
      const auto state = odometry.add(sample);
      const Eigen::Vector3d off = state->nav.T_map_body.translation() -
                                  motion.state(seconds(sample.stamp)).T_map_body.translation();
      largest = sample.stamp > Nanoseconds(0) ? std::max(largest, (off - before).norm()) : 0.0;
      before = off;
      end = off.norm();
    }
    EXPECT_LE(end, 1e-4);
    return largest;
  };
  EXPECT_GE(largest_step(0.0), 0.045);
  EXPECT_LE(largest_step(0.05), 0.008);
}

TEST(HighRate, AReadingCostsMicroseconds) {
  const test::WavyMotion motion = test::hand_held_motion();
  const auto samples = test::readings(motion, 0.0, 2.0, 1000.0, kStreamBias);
  HighRateOdometry odometry(kStreamNoise, 0.05);
  odometry.correct(estimate_at(motion, 0.0));
  const auto start = std::chrono::steady_clock::now();
  double sum = 0.0;
  for (const ImuSample& sample : samples) {
    sum += odometry.add(sample)->nav.T_map_body.translation().x();
  }
  const double each =
      std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count() /
      static_cast<double>(samples.size());
  EXPECT_TRUE(std::isfinite(sum));
  RecordProperty("microseconds", std::to_string(each));  // printed, not judged: machines differ
}

}  // namespace
}  // namespace adit
