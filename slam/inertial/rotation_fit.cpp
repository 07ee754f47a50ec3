// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/inertial/rotation_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "adit/slam/core/lie.hpp"

namespace adit {
namespace {

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

constexpr int kMostSteps = 20;
constexpr double kConverged = 1e-7;    // s and rad
constexpr double kLeastNoise = 1e-12;  // rad^2, of a turn
constexpr double kLongestStep = 0.2;   // rad

struct NormalEquations {
  Matrix7d h = Matrix7d::Zero();
  Vector7d g = Vector7d::Zero();
  double squares = 0.0;
};

NormalEquations normal_equations(std::span<const MeasuredTurn> turns,
                                 const GyroscopeIntegral& integral, const GyroscopeFrame& frame) {
  NormalEquations sums;
  for (const MeasuredTurn& turn : turns) {
    const TurnLinearization one = linearized(turn, integral, frame);
    sums.h += one.jacobian.transpose() * one.jacobian;
    sums.g += one.jacobian.transpose() * one.residual;
    sums.squares += one.residual.squaredNorm();
  }
  return sums;
}

struct Solution {
  Vector7d step = Vector7d::Zero();  ///< offset, mounting, bias
  double offset_sigma = std::numeric_limits<double>::infinity();
  Eigen::Vector3d eigenvalues = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  std::array<bool, 3> observable = {false, false, false};
};

/// The bias is eliminated, then the offset; what is left of the mounting is solved in the
/// directions that stand out. An offset that turns tell no better than to a second stays as it is.
Solution solve(const NormalEquations& sums, std::size_t turns) {
  Solution found;
  const auto n = static_cast<double>(turns);
  const double noise = std::max(sums.squares / std::max(1.0, 3.0 * n - 7.0), kLeastNoise);
  const Eigen::LDLT<Eigen::Matrix3d> bias(sums.h.bottomRightCorner<3, 3>());
  const Eigen::Matrix<double, 3, 4> across = sums.h.bottomLeftCorner<3, 4>();
  const Eigen::Vector3d g_bias = sums.g.tail<3>();
  const Eigen::Matrix4d h = sums.h.topLeftCorner<4, 4>() - across.transpose() * bias.solve(across);
  const Eigen::Vector4d g = sums.g.head<4>() - across.transpose() * bias.solve(g_bias);
  const bool timed = h(0, 0) > noise;
  const Eigen::Vector3d to_offset =
      timed ? Eigen::Vector3d(h.block<3, 1>(1, 0) / h(0, 0)) : Eigen::Vector3d::Zero();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> mounting(
      h.bottomRightCorner<3, 3>() - h(0, 0) * to_offset * to_offset.transpose());
  const Eigen::Vector3d g_mounting = g.tail<3>() - to_offset * g(0);

  found.axes = mounting.eigenvectors();
  found.eigenvalues = mounting.eigenvalues() / noise;
  double variance = 0.0;
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const bool observable = found.eigenvalues(i) > kLeastInformation * n;
    found.observable[static_cast<std::size_t>(i)] = observable;
    if (observable) {
      const Eigen::Vector3d axis = found.axes.col(i);
      turn -= axis * axis.dot(g_mounting) / mounting.eigenvalues()(i);
      variance += std::pow(to_offset.dot(axis), 2) / found.eigenvalues(i);
    }
  }
  turn *= std::min(1.0, kLongestStep / std::max(turn.norm(), kLongestStep));
  Eigen::Vector4d step = Eigen::Vector4d::Zero();
  step.tail<3>() = turn;
  if (timed) {
    step(0) = -g(0) / h(0, 0) - to_offset.dot(turn);
    found.offset_sigma = std::sqrt(noise / h(0, 0) + variance);
  }
  found.step << step, -bias.solve(g_bias + across * step);
  return found;
}

}  // namespace

TurnLinearization linearized(const MeasuredTurn& turn, const GyroscopeIntegral& integral,
                             const GyroscopeFrame& frame) {
  const double begin = turn.begin + frame.offset;
  const double end = turn.end + frame.offset;
  const Eigen::Vector3d turned =
      frame.R_range_gyro * (integral.angle(end, turn.span) - integral.angle(begin, turn.span));
  TurnLinearization result;
  result.residual = turn.rotation - turned - (turn.end - turn.begin) * frame.bias;
  result.jacobian.col(0) = -frame.R_range_gyro * (integral.angle_rate(end, turn.span) -
                                                  integral.angle_rate(begin, turn.span));
  result.jacobian.middleCols<3>(1) = skew(turned);
  result.jacobian.rightCols<3>() = -(turn.end - turn.begin) * Eigen::Matrix3d::Identity();
  return result;
}

RotationFit fit_rotations(std::span<const MeasuredTurn> turns, const GyroscopeIntegral& integral,
                          const GyroscopeFrame& start, double most_offset) {
  RotationFit fit;
  fit.frame = start;
  for (int i = 0; i < kMostSteps; ++i) {
    const Solution found = solve(normal_equations(turns, integral, fit.frame), turns.size());
    fit.frame.offset = std::clamp(fit.frame.offset + found.step(0), -most_offset, most_offset);
    fit.frame.R_range_gyro = so3_exp(found.step.segment<3>(1)) * fit.frame.R_range_gyro;
    fit.frame.bias += found.step.tail<3>();
    fit.offset_sigma = found.offset_sigma;
    fit.eigenvalues = found.eigenvalues;
    fit.axes = found.axes;
    fit.observable = found.observable;
    if (found.step.head<4>().norm() < kConverged) {
      break;
    }
  }
  return fit;
}

}  // namespace adit
