// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/odometry_drift.hpp"

#include <Eigen/Cholesky>

namespace adit {
namespace {

// One standard deviation of a run's rates before loops have shown them. Lidar odometries err by 0.3
// to 1.5 % of the path and 0.1 to 0.5 degrees per 100 m on KITTI; indoors a metre of path has more
// turns, and 2 degrees per 100 m are usual.
constexpr double kScale = 0.015;   // m/m
constexpr double kClimb = 0.015;   // m/m
constexpr double kTurn = 0.00035;  // rad/m
// The rates of one path differ from those of the run by this share of the prior.
constexpr double kVarying = 1.0 / 3.0;
// Besides, one step may be wrong: 1 of 240 in the simulated office by 0.21 m
// (docs/theory/loops.md).
constexpr double kStep = 0.2;       // m
constexpr double kStepTurn = 0.02;  // rad

// Chi squared of 4 and of 6 directions: 99.9 %.
constexpr double kLevelledQuantile = 18.47;
constexpr double kQuantile = 22.46;

DriftRates prior_variances() {
  DriftRates sigma;
  sigma << kScale, kClimb, kTurn, kTurn, kTurn;
  return sigma.cwiseAbs2();
}

constexpr double kNothingKnown = 1e4;  // rad^2

/// The covariance of a difference with nothing known of the directions that do not count.
Matrix6d counted(Matrix6d covariance, bool levelled) {
  if (levelled) {
    covariance.diagonal().segment<2>(3).array() += kNothingKnown;
  }
  return covariance;
}

}  // namespace

DriftResponse drift_response(const Eigen::Isometry3d& T_from_to, const Eigen::Vector3d& up) {
  const Eigen::Vector3d way = T_from_to.linear().transpose() * T_from_to.translation();
  const double length = way.norm();
  DriftResponse response = DriftResponse::Zero();
  response.block<3, 1>(0, 0) = way;
  response.block<3, 1>(0, 1) = length * up;
  response(3, 2) = length;
  response(4, 3) = length;
  response.block<3, 1>(3, 4) = length * up;
  return response;
}

void OdometryDrift::learn(const DriftDifference& shown, double weight) {
  const DriftResponse weighted =
      weight * counted(shown.covariance, shown.levelled).ldlt().solve(shown.response);
  information_ += weighted.transpose() * shown.response;
  vector_ += weighted.transpose() * shown.difference;
}

DriftRates OdometryDrift::rates() const {
  DriftRateMatrix information = information_;
  information.diagonal() += prior_variances().cwiseInverse();
  return information.ldlt().solve(vector_);
}

DriftRateMatrix OdometryDrift::covariance() const {
  DriftRateMatrix information = information_;
  information.diagonal() += prior_variances().cwiseInverse();
  DriftRateMatrix covariance = information.ldlt().solve(DriftRateMatrix::Identity());
  covariance.diagonal() += kVarying * kVarying * prior_variances();
  return covariance;
}

double OdometryDrift::excess(const DriftDifference& claimed) const {
  Matrix6d predicted =
      claimed.covariance + claimed.response * covariance() * claimed.response.transpose();
  predicted.diagonal().head<3>().array() += kStep * kStep;
  predicted.diagonal().tail<3>().array() += kStepTurn * kStepTurn;
  const Vector6d off = claimed.difference - claimed.response * rates();
  return off.dot(counted(predicted, claimed.levelled).ldlt().solve(off)) /
         (claimed.levelled ? kLevelledQuantile : kQuantile);
}

}  // namespace adit
