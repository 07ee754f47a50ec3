// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/sliding_graph.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <variant>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "adit/tests/support/simulated_imu.hpp"

namespace adit {
namespace {

constexpr ImuNoise kGraphNoise{.gyro = 1e-3, .accel = 1e-2, .gyro_walk = 3e-5, .accel_walk = 3e-4};
constexpr double kGraphRate = 200.0;
constexpr double kGraphSweep = 0.1;    // s
constexpr double kPoseSigma = 0.02;    // m
constexpr double kAngleSigma = 0.003;  // rad
const ImuBias kGraphBias{{0.02, -0.01, 0.015}, {0.08, -0.05, 0.1}};

StateVector start_sigma() {
  StateVector sigma;
  sigma << Eigen::Vector3d::Constant(0.02), Eigen::Vector3d::Constant(0.01),
      Eigen::Vector3d::Constant(0.1), Eigen::Vector3d::Constant(0.02),
      Eigen::Vector3d::Constant(0.1), Eigen::Vector2d::Constant(0.02),
      Eigen::Vector3d::Constant(0.05);
  return sigma;
}

/// A drive of which the sweeps' poses are measured and the readings are noisy.
struct GraphDrive {
  std::vector<NavState> truth;  ///< at each sweep
  StatePrior start;
  std::vector<std::vector<ImuSample>> readings;  ///< up to sweep i; none for the first
  std::vector<PoseMeasurement> measurements;
};

GraphDrive drive(int sweeps, uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(random); };
  const test::WavyMotion motion = test::hand_held_motion();
  GraphDrive result;
  ImuBias bias = kGraphBias;
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(kPoseSigma), Eigen::Vector3d::Constant(kAngleSigma);
  for (int i = 0; i < sweeps; ++i) {
    const double time = kGraphSweep * i;
    NavState truth = motion.state(time);
    truth.bias = bias;
    result.truth.push_back(truth);
    if (i == 0) {
      StateVector error = start_sigma();
      for (int k = 0; k < kScaleAt; ++k) {
        error[k] *= draw();
      }
      error.tail<3>().setZero();  // there is no sensor of velocities
      result.start = independent_prior(retract(truth, error), start_sigma());
      result.readings.emplace_back();
    } else {
      // The bias walks once a sweep.
      auto samples = test::readings(motion, time - kGraphSweep, time, kGraphRate,
                                    result.truth[static_cast<size_t>(i) - 1].bias);
      test::add_noise(samples, kGraphNoise, kGraphRate, random);
      result.readings.push_back(samples);
    }
    PoseMeasurement measurement;
    measurement.T_map_body =
        retract(truth.T_map_body, Vector6d(sigma.cwiseProduct(Vector6d::NullaryExpr(draw))));
    measurement.root_information = sigma.cwiseInverse().asDiagonal();
    measurement.known_directions = 6;
    result.measurements.push_back(measurement);
    bias.gyro +=
        kGraphNoise.gyro_walk * std::sqrt(kGraphSweep) * Eigen::Vector3d::NullaryExpr(draw);
    bias.accel +=
        kGraphNoise.accel_walk * std::sqrt(kGraphSweep) * Eigen::Vector3d::NullaryExpr(draw);
  }
  return result;
}

GraphSettings settings(int lag, int reset = 0) {
  return {.noise = kGraphNoise, .gravity_walk = 1e-5, .lag = lag, .reset = reset};
}

/// The estimate after each sweep.
std::vector<StateEstimate> run(const GraphDrive& d, const GraphSettings& s) {
  SlidingGraph graph(s);
  graph.start(d.start);
  std::vector<StateEstimate> estimates = {std::get<StateEstimate>(graph.latest_estimate())};
  for (size_t i = 1; i < d.truth.size(); ++i) {
    estimates.push_back(std::get<StateEstimate>(graph.add(d.readings[i], d.measurements[i])));
  }
  return estimates;
}

double rms(const std::vector<StateEstimate>& estimates, const GraphDrive& d, int at, size_t from) {
  double squares = 0.0;
  for (size_t i = from; i < estimates.size(); ++i) {
    squares += difference(d.truth[i], estimates[i].state).segment<3>(at).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(estimates.size() - from));
}

TEST(SlidingGraph, IsBetterThanWhatItIsGiven) {
  const GraphDrive d = drive(150, 1);
  const auto estimates = run(d, settings(20));
  EXPECT_LE(rms(estimates, d, kPositionAt, 50), 0.6 * std::sqrt(3.0) * kPoseSigma);
  EXPECT_LE(rms(estimates, d, kRotationAt, 50), 0.6 * std::sqrt(3.0) * kAngleSigma);
  EXPECT_LE(rms(estimates, d, kVelocityAt, 50), 0.06);
  EXPECT_LE(rms(estimates, d, kGyroBiasAt, 100), 1.5e-3);
  EXPECT_LE(rms(estimates, d, kAccelBiasAt, 100), 0.04);
  for (const StateEstimate& estimate : estimates) {
    EXPECT_TRUE(estimate.converged) << seconds(estimate.state.stamp);
  }
}

// Over 50 runs, the squared errors are those that the covariances say, and innovations are white.
TEST(SlidingGraph, CovariancesAreTrueAndInnovationsWhite) {
  const int runs = 50;
  const int sweeps = 40;
  double pose = 0.0;
  double whole = 0.0;
  double nis = 0.0;
  double correlation = 0.0;
  int innovations = 0;
  for (int k = 0; k < runs; ++k) {
    const GraphDrive d = drive(sweeps, 100 + static_cast<uint64_t>(k));
    SlidingGraph graph(settings(20));
    graph.start(d.start);
    Vector6d last = Vector6d::Zero();
    for (size_t i = 1; i < d.truth.size(); ++i) {
      const auto prediction = std::get<StateEstimate>(graph.predict(d.readings[i]));
      const Innovation found = innovation(prediction, d.measurements[i]);
      const auto estimate = std::get<StateEstimate>(graph.add(d.readings[i], d.measurements[i]));
      if (i >= 10) {
        const Vector6d unit = found.error.normalized();
        nis += found.nis;
        correlation += i > 10 ? unit.dot(last) : 0.0;
        ++innovations;
        last = unit;
      }
      if (i + 1 == d.truth.size()) {
        const StateVector error = difference(d.truth[i], estimate.state);
        whole += error.dot(estimate.covariance.ldlt().solve(error)) / runs;
        const Matrix6d of_pose = estimate.covariance.topLeftCorner<6, 6>();
        pose += error.head<6>().dot(of_pose.ldlt().solve(error.head<6>())) / runs;
      }
    }
  }
  nis /= innovations;
  correlation /= innovations;
  RecordProperty("nees_pose", std::to_string(pose));
  RecordProperty("nees_state", std::to_string(whole));
  RecordProperty("nis", std::to_string(nis));
  RecordProperty("correlation", std::to_string(correlation));
  EXPECT_NEAR(pose, 6.0, 3.0 * std::sqrt(12.0 / runs));
  EXPECT_NEAR(whole, kStateSize, 3.0 * std::sqrt(2.0 * kStateSize / runs));
  EXPECT_NEAR(nis, 6.0, 0.5);
  EXPECT_NEAR(correlation, 0.0, 0.06);
}

TEST(SlidingGraph, ALagLosesNextToNothingAgainstAllOfThePast) {
  const GraphDrive d = drive(80, 5);
  const auto whole = run(d, settings(1000));
  const auto lag = run(d, settings(20));
  const auto reset = run(d, settings(0, 25));
  for (size_t i = 1; i < d.truth.size(); ++i) {
    const StateVector sigma = whole[i].covariance.diagonal().cwiseSqrt();
    const auto off = [&](const StateEstimate& estimate) {
      return difference(whole[i].state, estimate.state).cwiseQuotient(sigma).cwiseAbs().maxCoeff();
    };
    EXPECT_LE(off(lag[i]), 0.05) << "sweep " << i;
    EXPECT_LE(off(reset[i]), 0.15) << "sweep " << i;
    EXPECT_TRUE(lag[i].covariance.diagonal().isApprox(whole[i].covariance.diagonal(), 0.02))
        << "sweep " << i;
  }
}

TEST(SlidingGraph, TheSeamAtAResetIsInvisible) {
  const GraphDrive d = drive(60, 7);
  SlidingGraph graph(settings(0, 25));
  graph.start(d.start);
  int seams = 0;
  for (size_t i = 1; i < d.truth.size(); ++i) {
    const auto before = std::get<StateEstimate>(graph.add(d.readings[i], d.measurements[i]));
    if (graph.size() > 1) {
      continue;
    }
    ++seams;
    // What is left after the reset is the state before it: the same pose, velocity and biases, with
    // the same covariance, correlations and all. (How little the next estimates differ from those
    // without a reset, the test above says.)
    const auto after = std::get<StateEstimate>(graph.latest_estimate());
    EXPECT_LE(difference(before.state, after.state).norm(), 1e-15);
    EXPECT_TRUE(after.covariance.isApprox(before.covariance, 1e-6));
    EXPECT_GT(std::abs(after.covariance(kPositionAt, kVelocityAt)), 0.0);
  }
  EXPECT_EQ(seams, 2);
}

TEST(SlidingGraph, AnUnknownDirectionIsTheInertialSensorsToCarry) {
  GraphDrive d = drive(60, 9);
  for (size_t i = 30; i < 60; ++i) {
    d.measurements[i].root_information.row(0).setZero();  // x of the body
    d.measurements[i].known_directions = 5;
    d.measurements[i].T_map_body.translation() +=
        d.measurements[i].T_map_body.linear() * Eigen::Vector3d(0.5, 0.0, 0.0);
  }
  const auto estimates = run(d, settings(20));
  const StateVector error = difference(d.truth[59], estimates[59].state);
  const double sigma = std::sqrt(estimates[59].covariance(0, 0));
  EXPECT_GT(sigma, 2.0 * std::sqrt(estimates[29].covariance(0, 0)));
  EXPECT_LE(std::abs(error[0]), 3.0 * sigma);
  EXPECT_LE(std::abs(error[0]), 0.3) << "0.5 m were claimed";
  EXPECT_LE(std::abs(error[1]), 0.05);
}

TEST(SlidingGraph, OneFalsePoseHardlyMovesIt) {
  GraphDrive d = drive(60, 11);
  const auto clean = run(d, settings(20));
  d.measurements[40].T_map_body.translation().x() += 1.0;
  const auto robust = run(d, settings(20));
  GraphSettings naive = settings(20);
  naive.robust = false;
  const auto pulled = run(d, naive);
  const auto off = [&](const std::vector<StateEstimate>& estimates) {
    return difference(clean[40].state, estimates[40].state).head<3>().norm();
  };
  EXPECT_LE(off(robust), 0.06);
  EXPECT_GT(off(pulled), 0.15);
}

TEST(SlidingGraph, WithoutAPoseItGoesOnByInertiaAndKnowsLess) {
  const GraphDrive d = drive(40, 13);
  SlidingGraph graph(settings(20));
  graph.start(d.start);
  for (size_t i = 1; i < 30; ++i) {
    graph.add(d.readings[i], d.measurements[i]);
  }
  double last = 0.0;
  for (size_t i = 30; i < 40; ++i) {
    const auto prediction = std::get<StateEstimate>(graph.predict(d.readings[i]));
    const auto estimate = std::get<StateEstimate>(graph.add(d.readings[i], std::nullopt));
    EXPECT_LE(difference(prediction.state, estimate.state).norm(), 1e-7);
    EXPECT_TRUE(estimate.covariance.isApprox(prediction.covariance, 1e-6));
    EXPECT_GT(estimate.covariance(0, 0), last);
    last = estimate.covariance(0, 0);
  }
  const StateVector error = difference(d.truth[39], graph.latest());
  EXPECT_LE(std::abs(error[0]), 3.5 * std::sqrt(last));
}

TEST(SlidingGraph, FarBiasesAreIntegratedAgain) {
  GraphDrive d = drive(60, 15);
  // Told that there are no biases, and that this is not certain: 0.03 rad/s off, past 2 mrad.
  d.start.origin.bias = {};
  StateVector sigma = start_sigma();
  sigma.segment<3>(kGyroBiasAt).setConstant(0.1);
  sigma.segment<3>(kAccelBiasAt).setConstant(0.5);
  d.start = independent_prior(d.start.origin, sigma);
  const auto estimates = run(d, settings(20));
  EXPECT_LE((estimates.back().state.bias.gyro - d.truth.back().bias.gyro).norm(), 2e-3);
  EXPECT_LE((estimates.back().state.bias.accel - d.truth.back().bias.accel).norm(), 0.08);
}

TEST(SlidingGraph, ItStopsOnceNothingMoves) {
  const GraphDrive d = drive(12, 19);
  SlidingGraph graph(settings(20));
  graph.start(d.start);
  for (size_t i = 1; i < 11; ++i) {
    graph.add(d.readings[i], d.measurements[i]);
  }
  // Where the pose is measured as predicted, the first step is none.
  SlidingGraph still = graph;
  PoseMeasurement expected = d.measurements[11];
  expected.T_map_body = std::get<StateEstimate>(graph.predict(d.readings[11])).state.T_map_body;
  const auto at_once = std::get<StateEstimate>(still.add(d.readings[11], expected));
  EXPECT_TRUE(at_once.converged);
  EXPECT_EQ(at_once.iterations, 1);
  // Elsewhere one step leads to the minimum, and the next shows that it was there.
  const auto moved = std::get<StateEstimate>(graph.add(d.readings[11], d.measurements[11]));
  EXPECT_TRUE(moved.converged);
  EXPECT_GE(moved.iterations, 2);
  EXPECT_LE(moved.iterations, 3);
}

TEST(SlidingGraph, WithoutTimeForItsStepsItHasNotConverged) {
  const GraphDrive d = drive(2, 19);
  GraphSettings hasty = settings(20);
  hasty.max_iterations = 1;
  SlidingGraph graph(hasty);
  graph.start(d.start);
  EXPECT_FALSE(std::get<StateEstimate>(graph.add(d.readings[1], d.measurements[1])).converged);
}

TEST(SlidingGraph, WhatNothingDeterminesIsNoEstimate) {
  const GraphDrive d = drive(2, 21);
  SlidingGraph graph(settings(20));
  graph.start(independent_prior(d.truth[0],
                                StateVector::Constant(std::numeric_limits<double>::infinity())));
  const GraphEstimate prediction = graph.predict(d.readings[1]);
  ASSERT_TRUE(std::holds_alternative<GraphFailure>(prediction));
  EXPECT_EQ(std::get<GraphFailure>(prediction), GraphFailure::undetermined);
  const GraphEstimate estimate = graph.add(d.readings[1], d.measurements[1]);
  ASSERT_TRUE(std::holds_alternative<GraphFailure>(estimate));
  EXPECT_EQ(std::get<GraphFailure>(estimate), GraphFailure::undetermined);
}

TEST(SlidingGraph, WhatIsNotFiniteIsNoEstimate) {
  GraphDrive d = drive(4, 23);
  SlidingGraph graph(settings(20));
  graph.start(d.start);
  graph.add(d.readings[1], d.measurements[1]);
  d.measurements[2].root_information(1, 1) = std::nan("");
  const GraphEstimate estimate = graph.add(d.readings[2], d.measurements[2]);
  ASSERT_TRUE(std::holds_alternative<GraphFailure>(estimate));
  EXPECT_EQ(std::get<GraphFailure>(estimate), GraphFailure::not_finite);
  graph.start(d.start);
  EXPECT_TRUE(std::holds_alternative<StateEstimate>(graph.add(d.readings[1], d.measurements[1])));
  d.readings[2][3].linear_acceleration.x() = std::nan("");
  const GraphEstimate prediction = graph.predict(d.readings[2]);
  ASSERT_TRUE(std::holds_alternative<GraphFailure>(prediction));
  EXPECT_EQ(std::get<GraphFailure>(prediction), GraphFailure::not_finite);
}

TEST(SlidingGraph, TheSameInputGivesTheSameBits) {
  const GraphDrive d = drive(30, 17);
  const auto a = run(d, settings(10));
  const auto b = run(d, settings(10));
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].state.T_map_body.matrix(), b[i].state.T_map_body.matrix());
    EXPECT_EQ(a[i].covariance, b[i].covariance);
  }
}

}  // namespace
}  // namespace adit
