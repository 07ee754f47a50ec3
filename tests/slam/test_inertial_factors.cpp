// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "adit/slam/fusion/imu_factor.hpp"
#include "adit/slam/fusion/pose_factor.hpp"
#include "adit/slam/fusion/state_prior.hpp"
#include "adit/slam/fusion/walk_factor.hpp"
#include "adit/tests/support/numerical_jacobian.hpp"
#include "adit/tests/support/simulated_imu.hpp"

namespace adit {
namespace {

constexpr ImuNoise kFactorNoise{.gyro = 1e-3, .accel = 1e-2, .gyro_walk = 1e-5, .accel_walk = 1e-4};
constexpr double kRelative = 1e-6;

class RandomStates {
 public:
  double number() { return normal_(engine_); }
  StateVector tangent(double pose, double velocity, double bias) {
    StateVector v = StateVector::NullaryExpr([&] { return number(); });
    v.head<6>() *= pose;
    v.segment<3>(kVelocityAt) *= velocity;
    v.segment<6>(kGyroBiasAt) *= bias;
    v.segment<2>(kGravityAt) *= 0.5;
    v.tail<3>() *= 0.1;
    return v;
  }

 private:
  std::mt19937_64 engine_{17};
  std::normal_distribution<double> normal_;
};

template <class Matrix>
void expect_same(const Matrix& analytic, const Matrix& numeric, const char* what) {
  // Block by block: rows of very different sizes hide each other in one norm.
  for (Eigen::Index row = 0; row < analytic.rows(); row += 3) {
    const auto rows = std::min<Eigen::Index>(3, analytic.rows() - row);
    const auto a = analytic.middleRows(row, rows);
    const auto n = numeric.middleRows(row, rows);
    EXPECT_LE((a - n).norm(), kRelative * std::max(n.norm(), 1.0)) << what << ", rows from " << row;
  }
}

TEST(InertialFactors, ImuJacobiansEqualNumericalDifferentiation) {
  RandomStates random;
  const test::WavyMotion motion = test::hand_held_motion();
  for (int run = 0; run < 20; ++run) {
    const double begin = 0.1 * run;
    const auto between =
        preintegrate(test::readings(motion, begin, begin + 0.1, 100.0), {}, kFactorNoise);
    // Far from where the factor is zero, and with biases that are not those integrated with.
    const NavState from = retract(motion.state(begin), random.tangent(0.3, 0.3, 0.01));
    const NavState to = retract(motion.state(begin + 0.1), random.tangent(0.3, 0.3, 0.01));
    const LinkFactor<9> factor = imu_factor(between, from, to);
    const auto by_from = test::numerical_jacobian<9, kStateSize>(
        [&](const StateVector& d) { return imu_factor(between, retract(from, d), to).residual; });
    const auto by_to = test::numerical_jacobian<9, kStateSize>(
        [&](const StateVector& d) { return imu_factor(between, from, retract(to, d)).residual; });
    expect_same<Eigen::Matrix<double, 9, kStateSize>>(factor.by_from, by_from, "imu by from");
    expect_same<Eigen::Matrix<double, 9, kStateSize>>(factor.by_to, by_to, "imu by to");
  }
}

TEST(InertialFactors, TheImuResidualIsZeroAtThePredictionAndWhite) {
  const test::WavyMotion motion = test::hand_held_motion();
  NavState from = motion.state(0.3);
  from.bias = {{0.002, -0.001, 0.003}, {0.02, 0.01, -0.03}};
  const auto samples = test::readings(motion, 0.3, 0.4, 200.0);
  const Preintegration between = preintegrate(samples, {}, kFactorNoise);
  const NavState to = predict(from, between);
  EXPECT_LE(imu_factor(between, from, to).residual.norm(), 1e-6);

  std::mt19937_64 engine(4);
  double squares = 0.0;
  for (int run = 0; run < 500; ++run) {
    auto noisy = samples;
    test::add_noise(noisy, kFactorNoise, 200.0, engine);
    const Preintegration sum = preintegrate(noisy, {}, kFactorNoise);
    squares += imu_factor(sum, from, to).residual.squaredNorm() / 500;
  }
  EXPECT_NEAR(squares, 9.0, 0.8);
}

TEST(InertialFactors, AnImuFactorOfASingleStepIsRegular) {
  const test::WavyMotion motion = test::hand_held_motion();
  const auto between = preintegrate(test::readings(motion, 0.0, 0.01, 100.0), {}, kFactorNoise);
  const LinkFactor<9> factor = imu_factor(between, motion.state(0.0), motion.state(0.01));
  EXPECT_TRUE(factor.residual.allFinite() && factor.by_from.allFinite());
}

TEST(InertialFactors, WalkJacobiansEqualNumericalDifferentiation) {
  RandomStates random;
  constexpr double kGravitySigma = 1e-3;
  const NavState from = retract(NavState{}, random.tangent(1.0, 1.0, 0.1));
  const NavState to = retract(NavState{}, random.tangent(1.0, 1.0, 0.1));
  const LinkFactor<12> factor = walk_factor(kFactorNoise, kGravitySigma, 0.1, from, to);
  EXPECT_NEAR(factor.residual[1],
              (to.bias.gyro - from.bias.gyro).y() / (kFactorNoise.gyro_walk * std::sqrt(0.1)),
              1e-9);
  NavState tilted = from;
  tilted.gravity_map = turned(from.gravity_map, {0.001, 0.0});
  EXPECT_NEAR(
      walk_factor(kFactorNoise, kGravitySigma, 1.0, from, tilted).residual.segment<3>(6).norm(),
      1.0, 1e-6);
  expect_same<Eigen::Matrix<double, 12, kStateSize>>(
      factor.by_from, test::numerical_jacobian<12, kStateSize>([&](const StateVector& d) {
        return walk_factor(kFactorNoise, kGravitySigma, 0.1, retract(from, d), to).residual;
      }),
      "walk by from");
  expect_same<Eigen::Matrix<double, 12, kStateSize>>(
      factor.by_to, test::numerical_jacobian<12, kStateSize>([&](const StateVector& d) {
        return walk_factor(kFactorNoise, kGravitySigma, 0.1, from, retract(to, d)).residual;
      }),
      "walk by to");
}

/// An alignment that holds all directions but those along `unknown` (lidar axes), if not zero.
RegistrationResult alignment(RandomStates& random, const Eigen::Vector3d& unknown) {
  RegistrationResult result;
  result.T_target_source = retract(Eigen::Isometry3d::Identity(),
                                   Vector6d::NullaryExpr([&] { return random.number(); }));
  const Matrix6d a = Matrix6d::NullaryExpr([&] { return random.number(); });
  result.information = 1e5 * (a * a.transpose() + 0.1 * Matrix6d::Identity());
  if (unknown.norm() > 0.0) {
    Matrix6d keep = Matrix6d::Identity();
    keep.topLeftCorner<3, 3>() -= unknown * unknown.transpose();
    result.information = keep * result.information * keep;
  }
  result.inliers = result.matches = result.source_points = 1000;
  result.overlap = 1.0;
  result.status = RegistrationStatus::converged;
  return result;
}

constexpr CovarianceModel kModel{.kappa = 2.0, .sigma_translation = 0.01, .sigma_rotation = 0.001};

Eigen::Isometry3d mounting() {
  Vector6d xi;
  xi << 0.2, -0.1, 0.3, 0.5, -1.0, 2.0;
  return se3_exp(xi);
}

TEST(InertialFactors, PoseJacobiansEqualNumericalDifferentiation) {
  RandomStates random;
  for (int run = 0; run < 20; ++run) {
    const PoseMeasurement measurement =
        measured_pose(alignment(random, Eigen::Vector3d(run % 2, 0.0, 0.0)), kModel, mounting());
    NavState state;
    state.T_map_body = measurement.T_map_body;
    state = retract(state, random.tangent(0.4, 1.0, 0.1));
    expect_same<Eigen::Matrix<double, 6, kStateSize>>(
        pose_factor(measurement, state).by_state,
        test::numerical_jacobian<6, kStateSize>([&](const StateVector& d) {
          return pose_factor(measurement, retract(state, d)).residual;
        }),
        "pose");
  }
}

TEST(InertialFactors, AMeasuredPoseHasTheCovarianceOfItsModel) {
  RandomStates random;
  const RegistrationResult result = alignment(random, Eigen::Vector3d::Zero());
  const Matrix6d of_lidar = covariance(result, kModel);
  const Matrix6d to_body = adjoint(mounting());
  const PoseMeasurement measurement = measured_pose(result, kModel, mounting());
  const Matrix6d information =
      measurement.root_information.transpose() * measurement.root_information;
  EXPECT_EQ(measurement.known_directions, 6);
  EXPECT_TRUE(
      Matrix6d(information.inverse()).isApprox(to_body * of_lidar * to_body.transpose(), 1e-6));
  EXPECT_TRUE(
      measurement.T_map_body.isApprox(result.T_target_source * mounting().inverse(), 1e-12));
}

// An alignment that a prior held off the optimum of its matches by `off` measured that optimum all
// the same: else the prior, which is the graph's own prediction, would count twice.
TEST(InertialFactors, AMeasuredPoseIsThatOfTheMatchesWhateverPriorWasWeighed) {
  RandomStates random;
  RegistrationResult result = alignment(random, Eigen::Vector3d::Zero());
  const Eigen::Isometry3d optimum = result.T_target_source;
  Vector6d off;
  off << 0.02, -0.01, 0.03, 0.004, -0.002, 0.001;
  result.T_target_source = optimum * se3_exp(off);
  result.pull = result.information * off;
  const PoseMeasurement measurement = measured_pose(result, kModel, mounting());
  EXPECT_TRUE(measurement.T_map_body.isApprox(optimum * mounting().inverse(), 1e-9));
}

TEST(InertialFactors, ADirectionThatNoMatchHoldsCarriesNothing) {
  RandomStates random;
  const Eigen::Vector3d axis(1.0, 0.0, 0.0);
  const RegistrationResult result = alignment(random, axis);
  const PoseMeasurement measurement = measured_pose(result, kModel, mounting());
  EXPECT_EQ(measurement.known_directions, 5);
  NavState state;
  state.T_map_body = measurement.T_map_body;
  const double at_it = pose_factor(measurement, state).residual.norm();
  state.T_map_body.translation() += 100.0 * (result.T_target_source.linear() * axis);
  EXPECT_NEAR(pose_factor(measurement, state).residual.norm(), at_it, 1e-6);
  state.T_map_body.translation() += result.T_target_source.linear() * Eigen::Vector3d::UnitY();
  EXPECT_GT(pose_factor(measurement, state).residual.norm(), 10.0);
}

TEST(InertialFactors, PriorJacobiansEqualNumericalDifferentiation) {
  RandomStates random;
  for (int run = 0; run < 20; ++run) {
    StatePrior prior;
    prior.origin = retract(NavState{}, random.tangent(1.0, 1.0, 0.1));
    prior.root = StateMatrix::NullaryExpr([&] { return random.number(); });
    prior.offset = StateVector::NullaryExpr([&] { return random.number(); });
    const NavState state = retract(prior.origin, random.tangent(0.4, 1.0, 0.1));
    expect_same<StateMatrix>(
        prior_factor(prior, state).by_state,
        test::numerical_jacobian<kStateSize, kStateSize>(
            [&](const StateVector& d) { return prior_factor(prior, retract(state, d)).residual; }),
        "prior");
  }
}

TEST(InertialFactors, APriorIsTheQuadraticItIsMadeOf) {
  RandomStates random;
  const NavState state = retract(NavState{}, random.tangent(1.0, 1.0, 0.1));
  const StateMatrix a = StateMatrix::NullaryExpr([&] { return random.number(); });
  StateVector units = StateVector::Ones();
  units.segment<3>(kGyroBiasAt).setConstant(1e4);
  StateQuadratic given;
  given.h = units.asDiagonal() * a * a.transpose() * units.asDiagonal();
  given.g = units.asDiagonal() * StateVector::NullaryExpr([&] { return random.number(); });
  const StateQuadratic back = quadratic(prior_factor(prior_from(state, given), state));
  EXPECT_LE((back.h - given.h).norm(), 1e-9 * given.h.norm());
  EXPECT_LE((back.g - given.g).norm(), 1e-6 * given.g.norm());

  StateVector sigma = StateVector::LinSpaced(0.1, 1.5);
  const StateQuadratic independent =
      quadratic(prior_factor(independent_prior(state, sigma), state));
  EXPECT_TRUE(
      StateMatrix(independent.h.inverse()).isApprox(StateMatrix(sigma.cwiseAbs2().asDiagonal())));
}

TEST(InertialFactors, HubersKernelIsLinearBeyondNinetyFivePercent) {
  EXPECT_NEAR(huber_width(6), 3.549, 1e-3);
  EXPECT_NEAR(huber_width(3), 2.796, 1e-3);
  EXPECT_EQ(huber(4.0, 3.0).weight, 1.0);
  EXPECT_EQ(huber(4.0, 3.0).cost, 2.0);
  EXPECT_NEAR(huber(36.0, 3.0).weight, 0.5, 1e-12);
  EXPECT_NEAR(huber(36.0, 3.0).cost, 3.0 * 6.0 - 4.5, 1e-12);
  EXPECT_EQ(huber(36.0, 0.0).weight, 1.0);
}

}  // namespace
}  // namespace adit
