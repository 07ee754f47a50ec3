// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// When the sliding graph's optimisation is done.
#pragma once

#include <vector>

#include "adit/slam/fusion/state_chain.hpp"

namespace adit {

/// What the quadratics expect the cost to fall by with such steps to their minimum: half the
/// squared length of the whole step, in its own metric.
double expected_decrease(const ChainQuadratic& chain, const std::vector<StateVector>& steps);

/// No state moves farther than a thousandth of its own standard deviation: a step that need not be
/// made.
bool is_negligible(double expected_decrease);

/// The cost fell by less than a billionth: another step would not change it.
bool has_settled(double cost_before, double cost_after);

}  // namespace adit
