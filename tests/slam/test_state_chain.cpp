// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/state_chain.hpp"

#include <random>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

namespace adit {
namespace {

constexpr int kN = kStateSize;
constexpr int kStates = 5;
constexpr int kUnknowns = kN * kStates;

/// Random quadratics: priors on the first, rank-deficient ones on the others, links between.
ChainQuadratic random_chain(uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(engine); };
  ChainQuadratic chain;
  for (int i = 0; i < kStates; ++i) {
    StateFactor<kN> prior;
    StateFactor<6> pose;
    prior.by_state = StateMatrix::NullaryExpr(draw);
    prior.residual = StateVector::NullaryExpr(draw);
    pose.by_state.leftCols<6>() = Matrix6d::NullaryExpr(draw);
    pose.residual = Vector6d::NullaryExpr(draw);
    chain.states.push_back(i == 0 ? quadratic(prior) : quadratic(pose));
    if (i > 0) {
      LinkFactor<kN> link;
      link.by_from = StateMatrix::NullaryExpr(draw);
      link.by_to = StateMatrix::NullaryExpr(draw);
      link.residual = StateVector::NullaryExpr(draw);
      chain.links.push_back(quadratic(link));
    }
  }
  return chain;
}

struct Dense {
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(kUnknowns, kUnknowns);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(kUnknowns);
};

Dense dense(const ChainQuadratic& chain) {
  Dense sum;
  for (int i = 0; i < kStates; ++i) {
    sum.h.block<kN, kN>(kN * i, kN * i) += chain.states[static_cast<size_t>(i)].h;
    sum.g.segment<kN>(kN * i) += chain.states[static_cast<size_t>(i)].g;
    if (i > 0) {
      const LinkQuadratic& link = chain.links[static_cast<size_t>(i) - 1];
      sum.h.block<kN, kN>(kN * i - kN, kN * i - kN) += link.h_from;
      sum.h.block<kN, kN>(kN * i - kN, kN * i) += link.h_cross;
      sum.h.block<kN, kN>(kN * i, kN * i - kN) += link.h_cross.transpose();
      sum.h.block<kN, kN>(kN * i, kN * i) += link.h_to;
      sum.g.segment<kN>(kN * i - kN) += link.g_from;
      sum.g.segment<kN>(kN * i) += link.g_to;
    }
  }
  return sum;
}

TEST(StateChain, TheMinimumIsTheDenseSolutions) {
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const ChainQuadratic chain = random_chain(seed);
    Dense whole = dense(chain);
    for (const double damping : {0.0, 0.3}) {
      Eigen::MatrixXd h = whole.h;
      h.diagonal() *= 1.0 + damping;
      const Eigen::VectorXd expected = -h.ldlt().solve(whole.g);
      const auto found = minimum(chain, damping);
      ASSERT_TRUE(found);
      for (int i = 0; i < kStates; ++i) {
        EXPECT_LE((found->steps[static_cast<size_t>(i)] - expected.segment<kN>(kN * i)).norm(),
                  1e-9 * expected.norm())
            << "state " << i;
      }
    }
  }
}

TEST(StateChain, MarginalisationIsExactOnALinearProblem) {
  const ChainQuadratic chain = random_chain(3);
  const Dense whole = dense(chain);
  const int m = kUnknowns - kN;
  const Eigen::MatrixXd solved =
      whole.h.topLeftCorner(m, m).ldlt().solve(whole.h.topRightCorner(m, kN));
  const StateMatrix h =
      whole.h.bottomRightCorner(kN, kN) - whole.h.bottomLeftCorner(kN, m) * solved;
  const StateVector g = whole.g.tail(kN) - solved.transpose() * whole.g.head(m);
  const auto marginal = marginal_of_last(chain);
  ASSERT_TRUE(marginal);
  EXPECT_LE((marginal->h - h).norm(), 1e-9 * h.norm());
  EXPECT_LE((marginal->g - g).norm(), 1e-9 * g.norm());
  const auto found = minimum(chain, 0.0);
  ASSERT_TRUE(found);
  EXPECT_LE((found->last.h - h).norm(), 1e-9 * h.norm());
  EXPECT_LE((found->last.g - g).norm(), 1e-9 * g.norm());
  // Its inverse is the dense covariance's corner, and its minimum the dense solution's end.
  const Eigen::MatrixXd covariance = whole.h.inverse();
  EXPECT_TRUE(
      StateMatrix(marginal->h.inverse()).isApprox(covariance.bottomRightCorner(kN, kN), 1e-7));
  const Eigen::VectorXd solution = -whole.h.ldlt().solve(whole.g);
  EXPECT_LE((-marginal->h.ldlt().solve(marginal->g) - solution.tail(kN)).norm(), 1e-8);
  // And the least cost with the last state at its minimum is that of the whole.
  const double least = chain.cost() + 0.5 * whole.g.dot(solution);
  EXPECT_NEAR(marginal->cost - 0.5 * marginal->g.dot(marginal->h.ldlt().solve(marginal->g)), least,
              1e-8 * std::abs(least) + 1e-8);
}

TEST(StateChain, AStateThatNothingHoldsHasNoMinimum) {
  ChainQuadratic chain = random_chain(1);
  chain.states[0] = {};
  chain.links[0] = {};
  EXPECT_FALSE(minimum(chain, 0.0));
  EXPECT_FALSE(marginal_of_last(chain));
}

}  // namespace
}  // namespace adit
