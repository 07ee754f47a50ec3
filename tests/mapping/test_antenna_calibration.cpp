// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/gnss/antenna_calibration.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "adit/tests/mapping/antenna_drive.hpp"
#include "adit/tests/support/numerical_jacobian.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

TEST(AntennaCalibration, JacobiansAreThoseOfTheResidual) {
  const test::AntennaDrive drive(test::in_town(), 20.0, {.antenna = {0.1, 0.2, 0.3, 0.1}});
  for (const std::size_t i : {3U, 20U, 40U}) {
    const AntennaSighting& sighting = drive.sightings()[i];
    const Eigen::Isometry3d T_map_node =
        drive.graph().nodes()[drive.graph().index_of(sighting.node)].T_map_node;
    const Eigen::Isometry3d& T_world_map = drive.graph().T_world_map();
    const AntennaResidual row = antenna_residual(sighting, T_world_map, T_map_node);
    const auto residual = [&](const Vector6d& world, const Vector6d& node,
                              const AntennaError& error) -> Vector3d {
      return T_world_map * se3_exp(world) * T_map_node * se3_exp(node) *
                 p_node_antenna(sighting, error) -
             sighting.p_world;
    };
    const Vector6d still = Vector6d::Zero();
    const AntennaError right = AntennaError::Zero();
    EXPECT_LT((row.residual - residual(still, still, right)).norm(), 1e-12);
    const auto by_world = test::numerical_jacobian<3, 6>(
        [&](const Vector6d& x) { return residual(x, still, right); });
    const auto by_node = test::numerical_jacobian<3, 6>(
        [&](const Vector6d& x) { return residual(still, x, right); });
    const auto by_antenna = test::numerical_jacobian<3, 4>(
        [&](const AntennaError& x) { return residual(still, still, x); });
    EXPECT_LT((row.by_world - by_world).cwiseAbs().maxCoeff(), 1e-8);
    EXPECT_LT((row.by_node - by_node).cwiseAbs().maxCoeff(), 1e-8);
    EXPECT_LT((row.by_antenna - by_antenna).cwiseAbs().maxCoeff(), 1e-8);
  }
}

/// Rounds of optimising and correcting, as a map's end has them.
AntennaEstimate corrected_estimate(test::AntennaDrive& drive) {
  AntennaError sum = AntennaError::Zero();
  AntennaEstimate estimate;
  for (int round = 0; round < 3; ++round) {
    drive.take(sum);
    drive.optimize_graph();
    estimate = drive.estimate();
    sum += estimate.error;
  }
  estimate.error = sum;
  return estimate;
}

TEST(AntennaCalibration, ExactFixesTellTheErrorExactly) {
  const AntennaError truth(0.42, -0.15, 0.3, 0.12);
  test::AntennaDrive drive(test::in_town(), 200.0, {.antenna = truth});
  AntennaError sum = AntennaError::Zero();
  for (int round = 0; round < 4; ++round) {
    drive.take(sum);
    sum += drive.estimate().error;
  }
  EXPECT_LT((sum - truth).cwiseAbs().maxCoeff(), 1e-4) << sum.transpose();
}

TEST(AntennaCalibration, TellsTheErrorBesideNoiseOfFixesAndOdometry) {
  const AntennaError truth(0.42, -0.15, 0.3, 0.12);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    test::AntennaDrive drive(
        test::in_town(), 200.0,
        {.antenna = truth, .fix_sigma = 0.02, .edge_sigma = 0.02, .outliers = 0.1}, seed);
    const AntennaEstimate estimate = corrected_estimate(drive);
    const auto parameters = judged(estimate);
    EXPECT_TRUE(parameters[0].significant);
    EXPECT_TRUE(parameters[kDelay].significant);
    for (int i = 0; i < 4; ++i) {
      EXPECT_LT(std::abs(estimate.error(i) - truth(i)), 4.0 * std::sqrt(estimate.covariance(i, i)));
    }
  }
}

TEST(AntennaCalibration, FindsNothingWhereNothingIsWrong) {
  for (const double sigma : {0.012, 0.25, 1.5}) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      test::AntennaDrive drive(test::in_town(), 200.0, {.fix_sigma = sigma, .edge_sigma = 0.02},
                               seed);
      drive.optimize_graph();
      const AntennaEstimate estimate = drive.estimate();
      for (const AntennaParameter& parameter : judged(estimate)) {
        EXPECT_FALSE(parameter.significant);
      }
    }
  }
}

TEST(AntennaCalibration, AStraightWayDoesNotTellLeverArmFromDelay) {
  test::AntennaDrive drive(test::straight_on(), 100.0,
                           {.antenna = {0.5, 0.0, 0.0, 0.1}, .fix_sigma = 0.012});
  drive.optimize_graph();
  const AntennaEstimate estimate = drive.estimate();
  std::cout << estimate.error.transpose() << " sigma "
            << estimate.covariance.diagonal().cwiseSqrt().transpose() << "\n";
  for (const AntennaParameter& parameter : judged(estimate)) {
    EXPECT_FALSE(parameter.observable);
    EXPECT_FALSE(parameter.significant);
  }
}

}  // namespace
}  // namespace adit
