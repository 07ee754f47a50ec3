// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Factors at a linearisation point, and the quadratics that they add up to. Residuals are whitened:
// half their squares are a negative log likelihood.
#pragma once

#include <cmath>

#include "adit/slam/core/nav_state.hpp"

namespace adit {

/// A factor on one state.
template <int kRows>
struct StateFactor {
  Eigen::Matrix<double, kRows, 1> residual = Eigen::Matrix<double, kRows, 1>::Zero();
  Eigen::Matrix<double, kRows, kStateSize> by_state =
      Eigen::Matrix<double, kRows, kStateSize>::Zero();
};

/// A factor on two states that follow each other.
template <int kRows>
struct LinkFactor {
  Eigen::Matrix<double, kRows, 1> residual = Eigen::Matrix<double, kRows, 1>::Zero();
  Eigen::Matrix<double, kRows, kStateSize> by_from =
      Eigen::Matrix<double, kRows, kStateSize>::Zero();
  Eigen::Matrix<double, kRows, kStateSize> by_to = Eigen::Matrix<double, kRows, kStateSize>::Zero();
};

/// cost + g' d + d' H d / 2 in the tangent vector d of one state.
struct StateQuadratic {
  StateMatrix h = StateMatrix::Zero();
  StateVector g = StateVector::Zero();
  double cost = 0.0;

  StateQuadratic& operator+=(const StateQuadratic& other) {
    h += other.h;
    g += other.g;
    cost += other.cost;
    return *this;
  }
};

/// The same in those of two states.
struct LinkQuadratic {
  StateMatrix h_from = StateMatrix::Zero();
  StateMatrix h_cross = StateMatrix::Zero();  ///< rows of `from`, columns of `to`
  StateMatrix h_to = StateMatrix::Zero();
  StateVector g_from = StateVector::Zero();
  StateVector g_to = StateVector::Zero();
  double cost = 0.0;

  LinkQuadratic& operator+=(const LinkQuadratic& other) {
    h_from += other.h_from;
    h_cross += other.h_cross;
    h_to += other.h_to;
    g_from += other.g_from;
    g_to += other.g_to;
    cost += other.cost;
    return *this;
  }
};

/// What a robust kernel makes of a factor: its cost, and the weight of its rows.
struct RobustWeight {
  double cost = 0.0;
  double weight = 1.0;
};

/// Huber's kernel: linear beyond a norm of `width` standard deviations; 0: no kernel.
inline RobustWeight huber(double squared_norm, double width) {
  if (width <= 0.0 || squared_norm <= width * width) {
    return {0.5 * squared_norm, 1.0};
  }
  const double norm = std::sqrt(squared_norm);
  return {width * norm - 0.5 * width * width, width / norm};
}

/// Cauchy's kernel: logarithmic beyond a squared norm of `squared_width`; what is far off ends with
/// no weight.
inline RobustWeight cauchy(double squared_norm, double squared_width) {
  const double share = squared_norm / squared_width;
  return {0.5 * squared_width * std::log1p(share), 1.0 / (1.0 + share)};
}

template <int kRows>
StateQuadratic quadratic(const StateFactor<kRows>& factor, double huber_width = 0.0) {
  const RobustWeight robust = huber(factor.residual.squaredNorm(), huber_width);
  return {robust.weight * factor.by_state.transpose() * factor.by_state,
          robust.weight * factor.by_state.transpose() * factor.residual, robust.cost};
}

template <int kRows>
LinkQuadratic quadratic(const LinkFactor<kRows>& factor, const RobustWeight& robust) {
  const double weight = robust.weight;
  return {weight * factor.by_from.transpose() * factor.by_from,
          weight * factor.by_from.transpose() * factor.by_to,
          weight * factor.by_to.transpose() * factor.by_to,
          weight * factor.by_from.transpose() * factor.residual,
          weight * factor.by_to.transpose() * factor.residual,
          robust.cost};
}

template <int kRows>
LinkQuadratic quadratic(const LinkFactor<kRows>& factor) {
  return quadratic(factor, {0.5 * factor.residual.squaredNorm(), 1.0});
}

}  // namespace adit
