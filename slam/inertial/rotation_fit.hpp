// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Clock, mounting and bias of a gyroscope, all at once, from what another sensor on the same body
// turned (docs/theory/inertial.md, section 10).
#pragma once

#include <array>
#include <span>

#include <Eigen/Core>

#include "adit/slam/inertial/gyroscope_integral.hpp"

namespace adit {

/// What a range sensor turned between two times, s in its own clock.
struct MeasuredTurn {
  double begin = 0.0;
  double end = 0.0;
  double span = 0.0;  ///< s: between the mean attitudes over so much time from both on
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< rad, in the range sensor's axes
};

struct GyroscopeFrame {
  double offset = 0.0;  ///< s: the same motion has later times at the gyroscope by this much
  Eigen::Matrix3d R_range_gyro = Eigen::Matrix3d::Identity();
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  ///< rad/s, in the range sensor's axes
};

/// Derivative by [offset, mounting, bias]; the mounting is perturbed on the left, R <- Exp(phi) R,
/// in the range sensor's axes.
using TurnJacobian = Eigen::Matrix<double, 3, 7>;

struct TurnLinearization {
  Eigen::Vector3d residual = Eigen::Vector3d::Zero();  ///< rad: the turn less the gyroscope's
  TurnJacobian jacobian = TurnJacobian::Zero();
};
TurnLinearization linearized(const MeasuredTurn& turn, const GyroscopeIntegral& integral,
                             const GyroscopeFrame& frame);

/// Information of the mounting, in units of the residuals' and a turn: what is below says nothing
/// of an axis.
inline constexpr double kLeastInformation = 4.0;

struct RotationFit {
  GyroscopeFrame frame;  ///< as it was at the start in directions that the motion does not tell
  double offset_sigma = 0.0;  ///< s, standard deviation from the residuals; infinite: unobservable
  /// Information of the mounting, offset and bias unknown: eigenvalues in ascending order (1/rad²)
  /// and their axes, columns in the range sensor's frame. What is below kLeastInformation a turn is
  /// not observable: the motion about that axis does not stand out from the residuals.
  Eigen::Vector3d eigenvalues = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  std::array<bool, 3> observable = {false, false, false};
};

/// Least squares over turns that are covered with `most_offset` (s) to spare, by Gauss-Newton from
/// where `start` is: within a hundredth of a second of the right offset, and any mounting that is
/// not opposite to the right one.
RotationFit fit_rotations(std::span<const MeasuredTurn> turns, const GyroscopeIntegral& integral,
                          const GyroscopeFrame& start, double most_offset);

}  // namespace adit
