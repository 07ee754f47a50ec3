// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/convergence.hpp"

#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace adit {
namespace {

/// Three states with two links between them, none of which a minimum leaves out.
ChainQuadratic chain() {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(engine); };
  ChainQuadratic result;
  for (int i = 0; i < 3; ++i) {
    StateFactor<kStateSize> state;
    state.by_state = StateMatrix::NullaryExpr(draw);
    state.residual = StateVector::NullaryExpr(draw);
    result.states.push_back(quadratic(state));
    if (i > 0) {
      LinkFactor<kStateSize> link;
      link.by_from = StateMatrix::NullaryExpr(draw);
      link.by_to = StateMatrix::NullaryExpr(draw);
      link.residual = StateVector::NullaryExpr(draw);
      result.links.push_back(quadratic(link));
    }
  }
  return result;
}

double value_at(const ChainQuadratic& c, const std::vector<StateVector>& d) {
  double sum = c.cost();
  for (size_t i = 0; i < d.size(); ++i) {
    sum += c.states[i].g.dot(d[i]) + 0.5 * d[i].dot(c.states[i].h * d[i]);
  }
  for (size_t i = 0; i + 1 < d.size(); ++i) {
    const LinkQuadratic& link = c.links[i];
    sum += link.g_from.dot(d[i]) + link.g_to.dot(d[i + 1]) + 0.5 * d[i].dot(link.h_from * d[i]) +
           0.5 * d[i + 1].dot(link.h_to * d[i + 1]) + d[i].dot(link.h_cross * d[i + 1]);
  }
  return sum;
}

TEST(Convergence, TheExpectedDecreaseIsThatOfTheQuadratics) {
  const ChainQuadratic c = chain();
  const auto found = minimum(c, 0.0);
  ASSERT_TRUE(found);
  const double decrease = c.cost() - value_at(c, found->steps);
  EXPECT_GT(decrease, 1.0);
  EXPECT_NEAR(expected_decrease(c, found->steps), decrease, 1e-9 * decrease);
}

TEST(Convergence, AStepOfLessThanAThousandthOfItsDeviationIsNotMade) {
  EXPECT_TRUE(is_negligible(0.0));
  EXPECT_TRUE(is_negligible(0.499e-6));
  EXPECT_FALSE(is_negligible(0.501e-6));
  EXPECT_FALSE(is_negligible(std::numeric_limits<double>::quiet_NaN()));
}

TEST(Convergence, ACostThatHardlyFallsHasSettled) {
  EXPECT_TRUE(has_settled(2.0, 2.0));
  EXPECT_TRUE(has_settled(2.0, 2.0 - 1.9e-9));
  EXPECT_FALSE(has_settled(2.0, 2.0 - 2.1e-9));
  EXPECT_FALSE(has_settled(2.0, 1.0));
}

}  // namespace
}  // namespace adit
