// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How far an odometry drifts: what its covariances say, and errors that grow steadily with its path
// (docs/theory/loops.md).
#pragma once

#include "adit/slam/core/lie.hpp"

namespace adit {

/// What an odometry measures too much of, a metre of path: scale (m/m), climb (m/m), turn about a
/// keyframe's x and y axes (rad/m), and turn about the vertical (rad/m).
inline constexpr int kDriftRates = 5;
using DriftRates = Eigen::Matrix<double, kDriftRates, 1>;
using DriftRateMatrix = Eigen::Matrix<double, kDriftRates, kDriftRates>;
/// Derivative of a pose's right perturbation [rho, phi] (m, rad) by the rates.
using DriftResponse = Eigen::Matrix<double, 6, kDriftRates>;

/// How a step of the odometry responds: measured = true * Exp(response * rates). `up` is the
/// vertical in the axes of `to`.
DriftResponse drift_response(const Eigen::Isometry3d& T_from_to, const Eigen::Vector3d& up);

/// Difference of a loop from an odometry's path between its keyframes: the right perturbation of
/// path * loop, whose expectation is response * rates.
struct DriftDifference {
  Vector6d difference = Vector6d::Zero();      ///< m, rad, in the later keyframe's axes
  Matrix6d covariance = Matrix6d::Identity();  ///< of the path and the loop, without the rates
  DriftResponse response = DriftResponse::Zero();
  /// Both keyframes know their vertical: tilts then say nothing of the path, as both were levelled.
  bool levelled = true;
};

/// Rates of an odometry as they are known from earlier experience and from accepted loops. A
/// Gaussian prior and linear measurements: the posterior is Gaussian.
class OdometryDrift {
 public:
  /// An accepted loop; `weight` is its share where several have the same path.
  void learn(const DriftDifference& shown, double weight = 1.0);

  /// Expectation.
  DriftRates rates() const;
  /// Covariance of the rates on any one path: of the run's rates, and of how they vary within it.
  DriftRateMatrix covariance() const;

  /// Squared Mahalanobis distance of a difference from its prediction, over the quantile that 99.9
  /// % of all right loops stay below (chi squared of 4 directions where both keyframes know their
  /// vertical, of 6 elsewhere): at most 1 where drift explains it.
  double excess(const DriftDifference& claimed) const;

  /// Logarithm of how much likelier the difference is where the place is seen again than where it
  /// is an alias, which may lie anywhere in the explored `volume` (m^3) and be turned any way.
  double log_odds(const DriftDifference& claimed, double volume) const;

 private:
  DriftDifference beyond_prediction(const DriftDifference& claimed) const;

  DriftRateMatrix information_ = DriftRateMatrix::Zero();  ///< of the loops
  DriftRates vector_ = DriftRates::Zero();
};

}  // namespace adit
