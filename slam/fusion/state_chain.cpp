// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/state_chain.hpp"

#include <Eigen/Cholesky>

namespace adit {
namespace {

/// Cholesky factors of H with its diagonal scaled to one, since units differ by many decades.
class ScaledCholesky {
 public:
  explicit ScaledCholesky(const StateMatrix& h)
      : scale_(h.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse()),
        llt_(StateMatrix(scale_.asDiagonal() * h * scale_.asDiagonal())) {}

  bool regular() const { return llt_.info() == Eigen::Success; }

  template <int kColumns>
  Eigen::Matrix<double, kStateSize, kColumns> solve(
      const Eigen::Matrix<double, kStateSize, kColumns>& b) const {
    const Eigen::Matrix<double, kStateSize, kColumns> scaled = scale_.asDiagonal() * b;
    return scale_.asDiagonal() * llt_.solve(scaled);
  }

 private:
  StateVector scale_;
  Eigen::LLT<StateMatrix> llt_;
};

StateQuadratic left_by(const ScaledCholesky& cholesky, const StateQuadratic& state,
                       const LinkQuadratic& link) {
  const StateVector g = state.g + link.g_from;
  const StateMatrix solved = cholesky.solve<kStateSize>(link.h_cross);
  const StateMatrix h = link.h_to - link.h_cross.transpose() * solved;
  return {.h = 0.5 * (h + h.transpose()),
          .g = link.g_to - solved.transpose() * g,
          .cost = state.cost + link.cost - 0.5 * g.dot(cholesky.solve<1>(g))};
}

}  // namespace

double ChainQuadratic::cost() const {
  double sum = 0.0;
  for (const StateQuadratic& state : states) {
    sum += state.cost;
  }
  for (const LinkQuadratic& link : links) {
    sum += link.cost;
  }
  return sum;
}

std::optional<StateQuadratic> eliminated(const StateQuadratic& state, const LinkQuadratic& link) {
  const ScaledCholesky cholesky(state.h + link.h_from);
  return cholesky.regular() ? std::optional(left_by(cholesky, state, link)) : std::nullopt;
}

std::optional<StateQuadratic> marginal_of_last(const ChainQuadratic& chain) {
  StateQuadratic sum = chain.states.front();
  for (size_t i = 0; i < chain.links.size(); ++i) {
    const std::optional<StateQuadratic> left = eliminated(sum, chain.links[i]);
    if (!left) {
      return std::nullopt;
    }
    sum = chain.states[i + 1];
    sum += *left;
  }
  return sum;
}

std::optional<ChainMinimum> minimum(const ChainQuadratic& chain, double damping) {
  const size_t n = chain.states.size();
  const auto damped = [&](size_t i) {
    StateQuadratic state = chain.states[i];
    StateVector diagonal = state.h.diagonal();
    diagonal += i > 0 ? StateVector(chain.links[i - 1].h_to.diagonal()) : StateVector::Zero();
    diagonal += i + 1 < n ? StateVector(chain.links[i].h_from.diagonal()) : StateVector::Zero();
    state.h.diagonal() += damping * diagonal;
    return state;
  };
  std::vector<ScaledCholesky> factors;  // one per state, with what those before it left
  std::vector<StateVector> gradients;
  StateQuadratic state = damped(0);
  for (size_t i = 0; i < n; ++i) {
    const bool last = i + 1 == n;
    factors.emplace_back(last ? state.h : StateMatrix(state.h + chain.links[i].h_from));
    if (!factors.back().regular()) {
      return std::nullopt;
    }
    gradients.push_back(last ? state.g : StateVector(state.g + chain.links[i].g_from));
    if (!last) {
      const StateQuadratic left = left_by(factors.back(), state, chain.links[i]);
      state = damped(i + 1);
      state += left;
    }
  }
  ChainMinimum result{.steps = std::vector<StateVector>(n, StateVector::Zero()), .last = state};
  for (size_t i = n; i-- > 0;) {
    StateVector g = gradients[i];
    if (i + 1 < n) {
      g += chain.links[i].h_cross * result.steps[i + 1];
    }
    result.steps[i] = -factors[i].solve<1>(g);
  }
  return result;
}

}  // namespace adit
