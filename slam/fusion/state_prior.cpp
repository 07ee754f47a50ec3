// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/state_prior.hpp"

#include <Eigen/Eigenvalues>

namespace adit {
namespace {

constexpr double kNegligible = 1e-12;

}  // namespace

StatePrior independent_prior(const NavState& state, const StateVector& sigma) {
  return {
      .origin = state, .root = sigma.cwiseInverse().asDiagonal(), .offset = StateVector::Zero()};
}

// With H = D^1/2 U L U' D^1/2: root = L^1/2 U' D^1/2, and root' offset = g.
StatePrior prior_from(const NavState& state, const StateQuadratic& quadratic) {
  const StateVector scale = quadratic.h.diagonal().cwiseMax(1e-300).cwiseSqrt();
  const StateMatrix unit_diagonal =
      scale.cwiseInverse().asDiagonal() * quadratic.h * scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<StateMatrix> eigen(unit_diagonal);
  const double least = kNegligible * eigen.eigenvalues().maxCoeff();
  const StateVector rotated =
      eigen.eigenvectors().transpose() * scale.cwiseInverse().cwiseProduct(quadratic.g);
  StatePrior prior;
  prior.origin = state;
  StateVector roots = StateVector::Zero();
  for (int i = 0; i < kStateSize; ++i) {
    if (eigen.eigenvalues()[i] > least) {
      roots[i] = std::sqrt(eigen.eigenvalues()[i]);
      prior.offset[i] = rotated[i] / roots[i];
    }
  }
  prior.root = roots.asDiagonal() * eigen.eigenvectors().transpose() * scale.asDiagonal();
  return prior;
}

StateFactor<kStateSize> prior_factor(const StatePrior& prior, const NavState& state) {
  const StateVector moved = difference(prior.origin, state);
  const Eigen::Vector3d turned = moved.segment<3>(kRotationAt);
  StateMatrix jacobian = StateMatrix::Identity();
  jacobian.block<3, 3>(kPositionAt, kPositionAt) =
      prior.origin.T_map_body.linear().transpose() * state.T_map_body.linear();
  jacobian.block<3, 3>(kRotationAt, kRotationAt) = so3_right_jacobian_inverse(turned);
  jacobian.block<2, 2>(kGravityAt, kGravityAt) =
      turn_between_by_to(prior.origin.gravity_map, state.gravity_map);
  return {.residual = prior.root * moved + prior.offset, .by_state = prior.root * jacobian};
}

}  // namespace adit
