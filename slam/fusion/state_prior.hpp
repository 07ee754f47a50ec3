// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adit/slam/fusion/linearization.hpp"

namespace adit {

/// All that is known of a state from what has been left behind, correlations included:
/// |root (x [-] origin) + offset|² / 2. Where it was linearised stays fixed for ever.
struct StatePrior {
  NavState origin;
  StateMatrix root = StateMatrix::Zero();
  StateVector offset = StateVector::Zero();
};

/// A prior about `state` with these standard deviations, in the order of tangent vectors.
StatePrior independent_prior(const NavState& state, const StateVector& sigma);

/// The prior that a quadratic at `state` is (marginalisation). Directions with less than 1e-12 of
/// the information of the best, after scaling to a unit diagonal, are dropped.
StatePrior prior_from(const NavState& state, const StateQuadratic& quadratic);

StateFactor<kStateSize> prior_factor(const StatePrior& prior, const NavState& state);

}  // namespace adit
