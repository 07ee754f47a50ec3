// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The odometry's own solver of chains against Ceres, on one window with the same factors; Ceres
// differentiates them numerically.
#include <cmath>
#include <random>
#include <vector>

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include "adit/slam/fusion/imu_factor.hpp"
#include "adit/slam/fusion/sliding_graph.hpp"
#include "adit/slam/fusion/walk_factor.hpp"
#include "adit/tests/support/simulated_imu.hpp"

namespace adit {
namespace {

constexpr ImuNoise kNoise{.gyro = 1e-3, .accel = 1e-2, .gyro_walk = 3e-5, .accel_walk = 3e-4};
constexpr double kGravityWalk = 1e-5;
constexpr int kChainSweeps = 18;  // fewer than the lag, so that nothing is marginalised
constexpr int kLinkRows = 21;     // of the IMU's factor and of what walks
constexpr double kSweep = 0.1;    // s
constexpr double kRate = 200.0;

/// A window as the sliding graph gets it.
struct Window {
  StatePrior start;
  std::vector<std::vector<ImuSample>> readings;  ///< up to sweep i; none for the first
  std::vector<PoseMeasurement> measurements;     ///< one per sweep but the first
};

Window window(uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(random); };
  const test::WavyMotion motion = test::hand_held_motion();
  const ImuBias bias{{0.01, -0.005, 0.008}, {0.04, -0.03, 0.05}};
  StateVector sigma;
  sigma << Eigen::Vector3d::Constant(0.02), Eigen::Vector3d::Constant(0.01),
      Eigen::Vector3d::Constant(0.1), Eigen::Vector3d::Constant(0.005),
      Eigen::Vector3d::Constant(0.05), Eigen::Vector2d::Constant(0.02),
      Eigen::Vector3d::Constant(0.05);
  Vector6d pose_sigma;
  pose_sigma << Eigen::Vector3d::Constant(0.02), Eigen::Vector3d::Constant(0.003);
  Window result;
  for (int i = 0; i < kChainSweeps; ++i) {
    NavState truth = motion.state(kSweep * i);
    truth.bias = bias;
    if (i == 0) {
      StateVector error = sigma;
      for (int k = 0; k < kScaleAt; ++k) {
        error[k] *= draw();
      }
      error.tail<3>().setZero();  // there is no sensor of velocities
      result.start = independent_prior(retract(truth, error), sigma);
      result.readings.emplace_back();
      result.measurements.emplace_back();
      continue;
    }
    auto samples = test::readings(motion, kSweep * (i - 1), kSweep * i, kRate, bias);
    test::add_noise(samples, kNoise, kRate, random);
    result.readings.push_back(samples);
    PoseMeasurement measurement;
    measurement.T_map_body =
        retract(truth.T_map_body, Vector6d(pose_sigma.cwiseProduct(Vector6d::NullaryExpr(draw))));
    measurement.root_information = pose_sigma.cwiseInverse().asDiagonal();
    measurement.known_directions = 6;
    result.measurements.push_back(measurement);
  }
  return result;
}

/// States as tangent vectors at where they are predicted.
NavState at(const NavState& origin, const double* delta) {
  return retract(origin, Eigen::Map<const StateVector>(delta));
}

struct PriorResidual {
  StatePrior prior;
  NavState origin;
  bool operator()(const double* x, double* residual) const {
    Eigen::Map<StateVector>{residual} = prior_factor(prior, at(origin, x)).residual;
    return true;
  }
};

struct PoseResidual {
  PoseMeasurement measurement;
  NavState origin;
  bool operator()(const double* x, double* residual) const {
    Eigen::Map<Vector6d>{residual} = pose_factor(measurement, at(origin, x)).residual;
    return true;
  }
};

struct LinkResidual {
  Preintegration between;
  NavState from;
  NavState to;
  bool operator()(const double* x, const double* y, double* residual) const {
    const NavState first = at(from, x);
    const NavState second = at(to, y);
    Eigen::Map<Eigen::Matrix<double, kLinkRows, 1>>{residual}
        << imu_factor(between, first, second).residual,
        walk_factor(kNoise, kGravityWalk * std::sqrt(between.duration), between.duration, first,
                    second)
            .residual;
    return true;
  }
};

/// The newest state of the window by Ceres.
NavState newest_by_ceres(const Window& window) {
  std::vector<NavState> origins = {window.start.origin};
  std::vector<Preintegration> between(1);
  for (std::size_t i = 1; i < window.readings.size(); ++i) {
    between.push_back(preintegrate(window.readings[i], origins.back().bias, kNoise));
    origins.push_back(predict(origins.back(), between.back()));
  }
  std::vector<StateVector> deltas(origins.size(), StateVector::Zero());
  ceres::Problem problem;
  const auto add_prior = new PriorResidual{window.start, origins[0]};
  problem.AddResidualBlock(
      new ceres::NumericDiffCostFunction<PriorResidual, ceres::CENTRAL, kStateSize, kStateSize>(
          add_prior),
      nullptr, deltas[0].data());
  for (std::size_t i = 1; i < origins.size(); ++i) {
    problem.AddResidualBlock(new ceres::NumericDiffCostFunction<LinkResidual, ceres::CENTRAL,
                                                                kLinkRows, kStateSize, kStateSize>(
                                 new LinkResidual{between[i], origins[i - 1], origins[i]}),
                             nullptr, deltas[i - 1].data(), deltas[i].data());
    problem.AddResidualBlock(
        new ceres::NumericDiffCostFunction<PoseResidual, ceres::CENTRAL, 6, kStateSize>(
            new PoseResidual{window.measurements[i], origins[i]}),
        new ceres::HuberLoss(huber_width(6)), deltas[i].data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = 1e-14;
  options.max_num_iterations = 100;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  EXPECT_EQ(summary.termination_type, ceres::CONVERGENCE);
  return retract(origins.back(), deltas.back());
}

TEST(ChainSolver, EndsWhereCeresEnds) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const Window w = window(seed);
    SlidingGraph graph({.noise = kNoise,
                        .gravity_walk = kGravityWalk,
                        .lag = kChainSweeps + 2,
                        .max_iterations = 30});
    graph.start(w.start);
    StateEstimate estimate;
    for (std::size_t i = 1; i < w.readings.size(); ++i) {
      estimate = std::get<StateEstimate>(graph.add(w.readings[i], w.measurements[i]));
    }
    const StateVector apart = difference(newest_by_ceres(w), estimate.state);
    const StateVector sigma = estimate.covariance.diagonal().cwiseSqrt();
    // What remains: each integrates about another bias, to first order.
    EXPECT_LT(apart.cwiseQuotient(sigma).cwiseAbs().maxCoeff(), 0.02) << seed;
    EXPECT_LT(apart.head<3>().norm(), 2e-5);
    EXPECT_LT(apart.segment<3>(kRotationAt).norm(), 5e-6);
  }
}

}  // namespace
}  // namespace adit
