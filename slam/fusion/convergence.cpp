// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/convergence.hpp"

#include <cstddef>

namespace adit {
namespace {

constexpr double kSmallStep = 1e-3;  // standard deviations
constexpr double kSmallDecrease = 1e-9;

}  // namespace

double expected_decrease(const ChainQuadratic& chain, const std::vector<StateVector>& steps) {
  double sum = 0.0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    sum -= 0.5 * chain.states[i].g.dot(steps[i]);
  }
  for (std::size_t i = 0; i < chain.links.size(); ++i) {
    sum -= 0.5 * (chain.links[i].g_from.dot(steps[i]) + chain.links[i].g_to.dot(steps[i + 1]));
  }
  return sum;
}

bool is_negligible(double expected_decrease) {
  return expected_decrease < 0.5 * kSmallStep * kSmallStep;
}

bool has_settled(double cost_before, double cost_after) {
  return cost_before - cost_after < kSmallDecrease * cost_before;
}

}  // namespace adit
