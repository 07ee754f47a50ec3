// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/odometry_drift.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

#include "adit/slam/core/chi_squared.hpp"

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

DriftRates prior_variances() {
  DriftRates sigma;
  sigma << kScale, kClimb, kTurn, kTurn, kTurn;
  return sigma.cwiseAbs2();
}

/// Leaves tilts out where both keyframes know their vertical: they add nothing to chi squared or to
/// a determinant then.
DriftDifference counted(DriftDifference one) {
  if (one.levelled) {
    one.difference.segment<2>(3).setZero();
    one.response.middleRows<2>(3).setZero();
    one.covariance.middleRows<2>(3).setZero();
    one.covariance.middleCols<2>(3).setZero();
    one.covariance.diagonal().segment<2>(3).setOnes();
  }
  return one;
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
  const DriftDifference one = counted(shown);
  const DriftResponse weighted = weight * one.covariance.ldlt().solve(one.response);
  information_ += weighted.transpose() * one.response;
  vector_ += weighted.transpose() * one.difference;
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

DriftDifference OdometryDrift::beyond_prediction(const DriftDifference& claimed) const {
  DriftDifference beyond = claimed;
  beyond.difference -= claimed.response * rates();
  beyond.covariance += claimed.response * covariance() * claimed.response.transpose();
  beyond.covariance.diagonal().head<3>().array() += kStep * kStep;
  beyond.covariance.diagonal().tail<3>().array() += kStepTurn * kStepTurn;
  return counted(beyond);
}

double OdometryDrift::excess(const DriftDifference& claimed) const {
  const DriftDifference beyond = beyond_prediction(claimed);
  return beyond.difference.dot(beyond.covariance.ldlt().solve(beyond.difference)) /
         kChiSquared999[claimed.levelled ? 4 : 6];
}

double OdometryDrift::log_odds(const DriftDifference& claimed, double volume) const {
  using std::numbers::pi;
  const DriftDifference beyond = beyond_prediction(claimed);
  const Eigen::LDLT<Matrix6d> solver(beyond.covariance);
  const double chi2 = beyond.difference.dot(solver.solve(beyond.difference));
  const double log_determinant = solver.vectorD().array().log().sum();
  const double directions = claimed.levelled ? 4.0 : 6.0;
  const double turns = claimed.levelled ? 2.0 * pi : 8.0 * pi * pi;
  return std::log(volume * turns) -
         0.5 * (chi2 + log_determinant + directions * std::log(2.0 * pi));
}

}  // namespace adit
