// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Least squares over states of which each is tied to the next: block tridiagonal, so elimination
// from the first to the last solves it, gives the last one's covariance, and marginalises.
#pragma once

#include <optional>
#include <vector>

#include "adit/slam/fusion/linearization.hpp"

namespace adit {

/// Quadratics on states in order of time, and on each pair of neighbours: one fewer.
struct ChainQuadratic {
  std::vector<StateQuadratic> states;
  std::vector<LinkQuadratic> links;

  double cost() const;
};

/// What a state and its link to the next leave on the next once the state is eliminated (Schur
/// complement): exact for the quadratics. None: the state is not determined.
std::optional<StateQuadratic> eliminated(const StateQuadratic& state, const LinkQuadratic& link);

/// The marginal on the last state.
std::optional<StateQuadratic> marginal_of_last(const ChainQuadratic& chain);

struct ChainMinimum {
  std::vector<StateVector> steps;  ///< step of every state, from where it is
  StateQuadratic last;             ///< the marginal on the last state
};

/// The minimum of the sum, with `damping` times the diagonal added (Levenberg-Marquardt). None:
/// the sum has no minimum.
std::optional<ChainMinimum> minimum(const ChainQuadratic& chain, double damping);

}  // namespace adit
