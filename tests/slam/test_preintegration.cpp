// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/preintegration.hpp"

#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "adit/tests/support/simulated_imu.hpp"

namespace adit {
namespace {

using test::hand_held_motion;
using test::readings;
using test::WavyMotion;

constexpr ImuNoise kIncrementNoise{
    .gyro = 2e-3, .accel = 2e-2, .gyro_walk = 1e-5, .accel_walk = 1e-4};
const Eigen::Vector3d kGravity(0.0, 0.0, -9.80665);

/// Error [position, rotation, velocity] of an increment against another.
Vector9d error_of(const MotionIncrement& estimate, const MotionIncrement& truth) {
  Vector9d error;
  error << estimate.position - truth.position,
      so3_log(truth.rotation.transpose() * estimate.rotation), estimate.velocity - truth.velocity;
  return error;
}

/// The increment that the states at both ends call for.
MotionIncrement increment_between(const NavState& from, const NavState& to) {
  const double t = seconds(to.stamp - from.stamp);
  const Eigen::Matrix3d R_body_map = from.T_map_body.linear().transpose();
  const Eigen::Vector3d moved = to.T_map_body.translation() - from.T_map_body.translation();
  return {R_body_map * to.T_map_body.linear(),
          R_body_map * (to.v_map_body - from.v_map_body - kGravity * t),
          R_body_map * (moved - from.v_map_body * t - 0.5 * kGravity * t * t)};
}

TEST(Preintegration, ConstantRatesHaveAClosedForm) {
  const Eigen::Vector3d omega(0.3, -0.7, 1.1);
  const Eigen::Vector3d accel(1.0, 2.0, -0.5);
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 2000; ++i) {
    samples.push_back({test::at_seconds(i / 2000.0), omega, accel});
  }
  const Preintegration sum = preintegrate(samples, {}, kIncrementNoise);
  // Velocity is the left Jacobian times a; position from the series of its integral.
  Eigen::Matrix3d term = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d position = Eigen::Matrix3d::Zero();
  for (int n = 0; n < 30; ++n) {
    position += term / ((n + 1.0) * (n + 2.0));
    term = (term * skew(omega) / (n + 1.0)).eval();
  }
  EXPECT_NEAR(sum.duration, 1.0, 1e-12);
  EXPECT_LE((sum.increment.rotation - so3_exp(omega)).norm(), 1e-12);
  EXPECT_LE((sum.increment.velocity - so3_right_jacobian(-omega) * accel).norm(), 1e-7);
  EXPECT_LE((sum.increment.position - position * accel).norm(), 1e-7);
}

enum class Quadrature { hold, middle_sample, middle_sample_and_rotation };

MotionIncrement integrated(std::span<const ImuSample> samples, Quadrature quadrature) {
  if (quadrature == Quadrature::middle_sample_and_rotation) {
    return preintegrate(samples, {}, kIncrementNoise).increment;
  }
  const double share = quadrature == Quadrature::hold ? 0.0 : 0.5;
  MotionIncrement sum;
  for (size_t i = 1; i < samples.size(); ++i) {
    const double dt = seconds(samples[i].stamp - samples[i - 1].stamp);
    const Eigen::Vector3d omega =
        (1.0 - share) * samples[i - 1].angular_velocity + share * samples[i].angular_velocity;
    const Eigen::Vector3d accel =
        sum.rotation * ((1.0 - share) * samples[i - 1].linear_acceleration +
                        share * samples[i].linear_acceleration);
    sum.position += sum.velocity * dt + 0.5 * dt * dt * accel;
    sum.velocity += dt * accel;
    sum.rotation = sum.rotation * so3_exp(omega * dt);
  }
  return sum;
}

struct QuadratureErrors {
  double rotation = 0.0;  ///< rad
  double velocity = 0.0;  ///< m/s
  double position = 0.0;  ///< m
};

/// Root mean square over 400 intervals of 0.1 s of a sensor that is waved about.
QuadratureErrors quadrature_errors(double rate, Quadrature quadrature) {
  const WavyMotion motion = hand_held_motion();
  Vector9d squares = Vector9d::Zero();
  const int runs = 400;
  for (int k = 0; k < runs; ++k) {
    const double begin = 0.0371 * k;
    const MotionIncrement truth = increment_between(motion.state(begin), motion.state(begin + 0.1));
    const auto samples = readings(motion, begin, begin + 0.1, rate);
    squares += error_of(integrated(samples, quadrature), truth).cwiseAbs2() / runs;
  }
  return {std::sqrt(squares.segment<3>(3).sum()), std::sqrt(squares.segment<3>(6).sum()),
          std::sqrt(squares.segment<3>(0).sum())};
}

// The table of docs/theory/inertial.md, section 2.
TEST(Preintegration, MidPointSamplesAndRotationBeatHoldingASampleTenfold) {
  for (const int rate : {100, 200}) {
    const QuadratureErrors hold = quadrature_errors(rate, Quadrature::hold);
    const QuadratureErrors sample = quadrature_errors(rate, Quadrature::middle_sample);
    const QuadratureErrors both = quadrature_errors(rate, Quadrature::middle_sample_and_rotation);
    int row = 0;
    for (const QuadratureErrors& e : {hold, sample, both}) {
      RecordProperty(std::to_string(rate) + " Hz, row " + std::to_string(++row),
                     std::to_string(1e3 * e.rotation) + " mrad " +
                         std::to_string(1e3 * e.velocity) + " mm/s " +
                         std::to_string(1e3 * e.position) + " mm");
    }
    EXPECT_LT(10.0 * both.rotation, hold.rotation) << rate << " Hz";
    EXPECT_LT(10.0 * both.velocity, hold.velocity) << rate << " Hz";
    EXPECT_LT(8.0 * both.position, hold.position) << rate << " Hz";
    EXPECT_LT(2.0 * both.velocity, sample.velocity) << rate << " Hz";
  }
  const QuadratureErrors coarse = quadrature_errors(100, Quadrature::middle_sample_and_rotation);
  const QuadratureErrors fine = quadrature_errors(200, Quadrature::middle_sample_and_rotation);
  EXPECT_NEAR(coarse.velocity / fine.velocity, 4.0, 0.6) << "second order";
  EXPECT_NEAR(coarse.rotation / fine.rotation, 4.0, 0.6) << "second order";
}

TEST(Preintegration, PredictsTheStateAtTheEnd) {
  const WavyMotion motion = hand_held_motion();
  const ImuBias bias{{0.01, -0.02, 0.03}, {0.1, -0.05, 0.02}};
  NavState state = motion.state(0.2);
  state.bias = bias;
  const Preintegration sum =
      preintegrate(readings(motion, 0.2, 0.7, 2000.0, bias), bias, kIncrementNoise);
  const NavState predicted = predict(state, sum);
  const StateVector error = difference(motion.state(0.7), predicted);
  EXPECT_EQ(predicted.stamp, motion.state(0.7).stamp);
  EXPECT_LE(error.head<9>().norm(), 3e-5);
  EXPECT_EQ(predicted.bias.gyro, bias.gyro);
  EXPECT_EQ(predicted.bias.accel, bias.accel);
}

TEST(Preintegration, BiasJacobiansEqualNumericalDifferentiation) {
  const WavyMotion motion = hand_held_motion();
  const ImuBias bias{{0.02, -0.03, 0.05}, {0.2, -0.1, 0.3}};
  const std::vector<ImuSample> samples = readings(motion, 0.1, 0.3, 200.0);
  const Preintegration sum = preintegrate(samples, bias, kIncrementNoise);
  Eigen::Matrix<double, 9, 6> analytic = Eigen::Matrix<double, 9, 6>::Zero();
  analytic << sum.position_by_gyro, sum.position_by_accel,  //
      sum.rotation_by_gyro, Eigen::Matrix3d::Zero(), sum.velocity_by_gyro, sum.velocity_by_accel;
  Eigen::Matrix<double, 9, 6> numeric;
  const double h = 1e-4;
  for (int i = 0; i < 6; ++i) {
    const auto moved = [&](double step) {
      ImuBias other = bias;
      (i < 3 ? other.gyro[i] : other.accel[i - 3]) += step;
      return error_of(preintegrate(samples, other, kIncrementNoise).increment, sum.increment);
    };
    // Fourth order, so that truncation stays below 1e-9.
    numeric.col(i) =
        (8.0 * (moved(h) - moved(-h)) - (moved(2.0 * h) - moved(-2.0 * h))) / (12.0 * h);
  }
  for (int block = 0; block < 3; ++block) {
    const double off = (analytic - numeric).middleRows<3>(3 * block).norm() /
                       numeric.middleRows<3>(3 * block).norm();
    EXPECT_LE(off, 1e-6) << "rows from " << 3 * block;
  }
}

TEST(Preintegration, TheFirstOrderCorrectionErrsToSecondOrder) {
  const std::vector<ImuSample> samples = readings(hand_held_motion(), 0.0, 0.1, 200.0);
  const Preintegration at_zero = preintegrate(samples, {}, kIncrementNoise);
  const auto error_at = [&](double size) {
    const ImuBias bias{size * Eigen::Vector3d(0.05, -0.04, 0.03),
                       size * Eigen::Vector3d(0.3, 0.2, -0.1)};
    return error_of(corrected(at_zero, bias),
                    preintegrate(samples, bias, kIncrementNoise).increment)
        .norm();
  };
  EXPECT_LT(error_at(1.0), 2e-4);
  EXPECT_NEAR(error_at(1.0) / error_at(0.5), 4.0, 0.2);
}

TEST(Preintegration, FarBiasesAskForANewIntegration) {
  const Preintegration sum =
      preintegrate(readings(hand_held_motion(), 0.0, 0.1, 200.0), {}, kIncrementNoise);
  EXPECT_FALSE(is_stale(sum, {{0.015, 0.0, 0.0}, {0.1, 0.1, 0.1}}));
  EXPECT_TRUE(is_stale(sum, {{0.025, 0.0, 0.0}, {0.0, 0.0, 0.0}}));
  EXPECT_TRUE(is_stale(sum, {{0.0, 0.0, 0.0}, {0.15, 0.15, 0.0}}));
}

// The normalised estimation error squared of 9 degrees of freedom is 9 on average, within three
// standard deviations of a mean over 1000 runs. (The first and the last reading count half, so with
// n of them the covariance is too large by about 1 / n.)
TEST(Preintegration, CovarianceIsThatOfAThousandNoisyRuns) {
  std::mt19937_64 random(20);
  const WavyMotion motion = hand_held_motion();
  const double rate = 200.0;
  const std::vector<ImuSample> clean = readings(motion, 0.3, 0.8, rate);
  const MotionIncrement truth = preintegrate(clean, {}, kIncrementNoise).increment;
  const int runs = 1000;
  double nees = 0.0;
  Matrix9d scatter = Matrix9d::Zero();
  Matrix9d covariance;
  for (int run = 0; run < runs; ++run) {
    std::vector<ImuSample> samples = clean;
    test::add_noise(samples, kIncrementNoise, rate, random);
    const Preintegration sum = preintegrate(samples, {}, kIncrementNoise);
    const Vector9d error = error_of(sum.increment, truth);
    nees += error.dot(sum.covariance.ldlt().solve(error)) / runs;
    scatter += error * error.transpose() / runs;
    covariance = sum.covariance;
  }
  RecordProperty("nees", std::to_string(nees));
  EXPECT_NEAR(nees, 9.0, 0.4);
  for (int i = 0; i < 9; ++i) {
    EXPECT_NEAR(scatter(i, i) / covariance(i, i), 1.0, 0.15) << "row " << i;
  }
}

// Sensors whose axes are neither as long nor as square as they should be, each in its own way.
TEST(Preintegration, ErrorsOfScaleAreInTheWholeCovariance) {
  constexpr double kScale = 0.01;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, kScale);
  const std::vector<ImuSample> samples = readings(hand_held_motion(), 1.0, 1.1, 200.0, {});
  const Preintegration exact = preintegrate(samples, {}, {.scale = kScale});
  Matrix9d sum = Matrix9d::Zero();
  constexpr int kRuns = 1000;
  for (int run = 0; run < kRuns; ++run) {
    const Eigen::Matrix3d gyro = Eigen::Matrix3d::NullaryExpr([&] { return normal(random); });
    const Eigen::Matrix3d accel = Eigen::Matrix3d::NullaryExpr([&] { return normal(random); });
    std::vector<ImuSample> wrong = samples;
    for (ImuSample& sample : wrong) {
      sample.angular_velocity += gyro * sample.angular_velocity;
      sample.linear_acceleration += accel * sample.linear_acceleration;
    }
    const Vector9d error = error_of(preintegrate(wrong, {}, {}).increment, exact.increment);
    sum += error * error.transpose();
  }
  const Vector9d found = (sum / kRuns).diagonal().cwiseSqrt();
  const Matrix9d own = whole_covariance(exact) - exact.covariance;
  const Vector9d told = own.diagonal().cwiseSqrt();
  for (int i = 0; i < 9; ++i) {
    EXPECT_NEAR(found[i] / told[i], 1.0, 0.25) << i;
  }
  EXPECT_TRUE(whole_covariance(preintegrate(samples, {}, kIncrementNoise))
                  .isApprox(preintegrate(samples, {}, kIncrementNoise).covariance));
}

TEST(Preintegration, ReadingsWithoutATimeBetweenThemChangeNothing) {
  const std::vector<ImuSample> samples = readings(hand_held_motion(), 0.0, 0.1, 100.0);
  std::vector<ImuSample> doubled;
  for (const ImuSample& sample : samples) {
    doubled.insert(doubled.end(), 2, sample);
  }
  const Preintegration once = preintegrate(samples, {}, kIncrementNoise);
  const Preintegration twice = preintegrate(doubled, {}, kIncrementNoise);
  EXPECT_EQ(once.increment.position, twice.increment.position);
  EXPECT_EQ(once.covariance, twice.covariance);
  EXPECT_EQ(preintegrate({}, {}, kIncrementNoise).duration, 0.0);
  EXPECT_EQ(preintegrate(std::span(samples).first(1), {}, kIncrementNoise).duration, 0.0);
}

TEST(NavState, DifferenceIsTheInverseOfRetract) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int run = 0; run < 100; ++run) {
    const NavState state =
        retract(NavState{}, StateVector::NullaryExpr([&] { return normal(random); }));
    StateVector delta = StateVector::NullaryExpr([&] { return 0.5 * normal(random); });
    EXPECT_LE((difference(state, retract(state, delta)) - delta).norm(), 1e-12);
  }
}

TEST(ImuPresets, AreSaneAndScaled) {
  for (const ImuPreset& preset : imu_presets()) {
    const auto once = imu_preset(preset.name, 1.0);
    const auto fivefold = imu_preset(preset.name, 5.0);
    ASSERT_TRUE(once && fivefold) << preset.name;
    EXPECT_DOUBLE_EQ(fivefold->gyro, 5.0 * once->gyro) << preset.name;
    EXPECT_DOUBLE_EQ(fivefold->accel_walk, 5.0 * once->accel_walk) << preset.name;
    EXPECT_GT(once->gyro, 1e-5) << preset.name;
    EXPECT_LT(once->gyro, 1e-3) << preset.name;
    EXPECT_GT(once->accel, 1e-4) << preset.name;
    EXPECT_LT(once->accel, 1e-2) << preset.name;
  }
  EXPECT_FALSE(imu_preset("bmi089", 1.0));
}

}  // namespace
}  // namespace adit
