// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The drift that an odometry is believed to have, and what loops show of it.
#include "adit/slam/graph/odometry_drift.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "adit/slam/graph/implied_drift.hpp"
#include "adit/slam/graph/relative_poses.hpp"
#include "adit/tests/mapping/graph_support.hpp"

namespace adit {
namespace {

using test::edge;
using test::step;
using test::up;

/// Measurements of a path whose truth is known: out along a bent line and back in reverse.
struct Drive {
  PoseGraph graph;
  std::vector<Eigen::Isometry3d> truth;
};

Drive drive(const DriftRates& rates, int steps, double bend, double sigma = 1e-3) {
  Drive made;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d believed = pose;
  for (NodeId id = 0; id <= steps; ++id) {
    if (id > 0) {
      const Eigen::Isometry3d way = step(1.0, bend);
      pose = pose * way;
      const Vector6d error = drift_response(way, Eigen::Vector3d::UnitZ()) * rates;
      const Eigen::Isometry3d measured = retract(way, error);
      believed = believed * measured;
      made.graph.add_node({.id = id, .T_map_node = pose});
      PoseEdge tie = edge(id - 1, id, measured);
      tie.information = test::diagonal_covariance(sigma, 0.1 * sigma).inverse();
      made.graph.add_edge(tie);
    } else {
      made.graph.add_node({.id = id});
    }
    made.truth.push_back(pose);
  }
  return made;
}

DriftDifference difference(const Drive& made, NodeId from, NodeId to,
                           const Eigen::Isometry3d& shift = Eigen::Isometry3d::Identity()) {
  const RelativeCovariances covariances(made.graph);
  RelativePoses relative(made.graph, covariances, Poses::measured, 4.0);
  return *drift_difference(
      relative, {.from = from,
                 .to = to,
                 .T_from_to = made.truth[static_cast<std::size_t>(from)].inverse() * shift *
                              made.truth[static_cast<std::size_t>(to)],
                 .covariance = test::diagonal_covariance(0.03, 0.003)});
}

Eigen::Isometry3d moved_aside(double metres) {
  Eigen::Isometry3d shift = Eigen::Isometry3d::Identity();
  shift.translation().y() = metres;
  return shift;
}

TEST(OdometryDrift, ResponseIsTheDerivativeOfWhatALoopShows) {
  constexpr double kRate = 1e-6;
  for (int rate = 0; rate < kDriftRates; ++rate) {
    const auto shown = [&](double value) {
      return difference(drive(value * DriftRates::Unit(rate), 30, 0.07), 3, 29).difference;
    };
    const Vector6d numerical = (shown(kRate) - shown(-kRate)) / (2.0 * kRate);
    const Vector6d response =
        difference(drive(DriftRates::Zero(), 30, 0.07), 3, 29).response.col(rate);
    EXPECT_LT((numerical - response).cwiseAbs().maxCoeff(), 1e-5 * response.norm()) << rate;
  }
}

TEST(OdometryDrift, LoopsTeachTheRates) {
  DriftRates rates = DriftRates::Zero();
  rates(1) = 0.02;
  rates(4) = 0.0004;
  OdometryDrift drift;
  const double before = drift.covariance()(1, 1);
  const Drive made = drive(rates, 90, 0.1);
  for (const NodeId to : {60, 70, 80}) {
    drift.learn(difference(made, 2, to));
  }
  EXPECT_NEAR(drift.rates()(1), rates(1), 2e-3);
  EXPECT_NEAR(drift.rates()(4), rates(4), 2e-5);
  EXPECT_LT(drift.covariance()(1, 1), 0.2 * before);
  EXPECT_GT(drift.covariance()(1, 1), 0.05 * before) << "rates vary along the path";
  const DriftDifference next = difference(made, 1, 90);
  EXPECT_LT(drift.excess(next), 0.2);
  EXPECT_GT(drift.excess(difference(made, 1, 90, up(3.0))), 1.0) << "another floor";
  EXPECT_LT(OdometryDrift().excess(difference(made, 1, 90, up(3.0))), 1.0) << "nothing is known";
}

// Round a square of 100 m a side: drift that moves a place aside also turns it, or it is what the
// covariances say.
TEST(OdometryDrift, APlaceAsideThatIsNotTurnedIsNoDrift) {
  const Drive round = drive(DriftRates::Zero(), 400, 2.0 * M_PI / 400.0, 0.02);
  const OdometryDrift drift;
  EXPECT_LT(drift.excess(difference(round, 3, 399)), 0.1);
  EXPECT_GT(drift.excess(difference(round, 3, 399, moved_aside(16.0))), 1.0) << "4 % of the path";
  DriftRates rates = DriftRates::Zero();
  rates(0) = 0.01;
  rates(4) = 0.0003;
  const Drive drifted = drive(rates, 400, 2.0 * M_PI / 400.0, 0.02);
  EXPECT_GT(difference(drifted, 3, 399).difference.head<3>().norm(), 5.0);
  EXPECT_LT(drift.excess(difference(drifted, 3, 399)), 0.5);
}

// The less an odometry knows, the less its agreement says.
TEST(OdometryDrift, OddsAreThoseOfTheDensities) {
  constexpr double kVolume = 1000.0;
  DriftDifference claimed{.covariance = test::diagonal_covariance(1.0, 0.1)};
  const auto odds = [&] { return OdometryDrift().log_odds(claimed, kVolume); };
  // A normal density of x, y, z and yaw at its mean, over one of all places and headings.
  const double place = 1.0 + 0.2 * 0.2;
  const double yaw = 0.1 * 0.1 + 0.02 * 0.02;
  const double density = 1.0 / (std::pow(2.0 * M_PI, 2) * std::sqrt(std::pow(place, 3) * yaw));
  EXPECT_NEAR(odds(), std::log(density * kVolume * 2.0 * M_PI), 1e-9);
  claimed.difference(1) = 2.0;
  claimed.difference(3) = 0.5;  // a tilt of levelled places
  EXPECT_NEAR(odds(), std::log(density * kVolume * 2.0 * M_PI) - 2.0 / place, 1e-9);
  claimed.covariance *= 100.0;
  EXPECT_LT(odds(), 0.0) << "an alias is likelier";
}

TEST(OdometryDrift, TiltsCountWhereNobodyKnowsTheVertical) {
  const Drive round = drive(DriftRates::Zero(), 60, 0.1);
  DriftDifference claimed = difference(round, 3, 59);
  claimed.difference(3) += 0.2;
  EXPECT_LT(OdometryDrift().excess(claimed), 1.0);
  claimed.levelled = false;
  EXPECT_GT(OdometryDrift().excess(claimed), 1.0);
}

}  // namespace
}  // namespace adit
