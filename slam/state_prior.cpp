// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "slam/state_prior.hpp"

#include <Eigen/Eigenvalues>

namespace adit {
namespace {

constexpr double kUnknown = 1e-12;

}  // namespace

StatePrior independent_prior(const NavState& state, const Vector15d& sigma) {
  return {.origin = state, .root = sigma.cwiseInverse().asDiagonal(), .offset = Vector15d::Zero()};
}

// With H = D^1/2 U L U' D^1/2: root = L^1/2 U' D^1/2, and root' offset = g.
StatePrior prior_from(const NavState& state, const StateQuadratic& quadratic) {
  const Vector15d scale = quadratic.h.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const Matrix15d unit_diagonal =
      scale.cwiseInverse().asDiagonal() * quadratic.h * scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix15d> eigen(unit_diagonal);
  const double least = kUnknown * eigen.eigenvalues().maxCoeff();
  const Vector15d rotated =
      eigen.eigenvectors().transpose() * scale.cwiseInverse().cwiseProduct(quadratic.g);
  StatePrior prior;
  prior.origin = state;
  Vector15d roots = Vector15d::Zero();
  for (int i = 0; i < 15; ++i) {
    if (eigen.eigenvalues()[i] > least) {
      roots[i] = std::sqrt(eigen.eigenvalues()[i]);
      prior.offset[i] = rotated[i] / roots[i];
    }
  }
  prior.root = roots.asDiagonal() * eigen.eigenvectors().transpose() * scale.asDiagonal();
  return prior;
}

StateFactor<15> prior_factor(const StatePrior& prior, const NavState& state) {
  const Vector15d moved = difference(prior.origin, state);
  const Eigen::Vector3d turned = moved.segment<3>(kRotationAt);
  Matrix15d jacobian = Matrix15d::Identity();
  jacobian.block<3, 3>(kPositionAt, kPositionAt) =
      prior.origin.T_map_body.linear().transpose() * state.T_map_body.linear();
  jacobian.block<3, 3>(kRotationAt, kRotationAt) = so3_right_jacobian_inverse(turned);
  return {.residual = prior.root * moved + prior.offset, .by_state = prior.root * jacobian};
}

}  // namespace adit
