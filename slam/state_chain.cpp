// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "slam/state_chain.hpp"

#include <Eigen/Cholesky>

namespace adit {
namespace {

/// Cholesky factors of H with its diagonal scaled to one, since units differ by many decades.
class ScaledCholesky {
 public:
  explicit ScaledCholesky(const Matrix15d& h)
      : scale_(h.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse()),
        llt_(Matrix15d(scale_.asDiagonal() * h * scale_.asDiagonal())) {}

  bool regular() const { return llt_.info() == Eigen::Success; }

  template <int kColumns>
  Eigen::Matrix<double, 15, kColumns> solve(const Eigen::Matrix<double, 15, kColumns>& b) const {
    const Eigen::Matrix<double, 15, kColumns> scaled = scale_.asDiagonal() * b;
    return scale_.asDiagonal() * llt_.solve(scaled);
  }

 private:
  Vector15d scale_;
  Eigen::LLT<Matrix15d> llt_;
};

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
  if (!cholesky.regular()) {
    return std::nullopt;
  }
  const Vector15d g = state.g + link.g_from;
  const Matrix15d solved = cholesky.solve<15>(link.h_cross);
  const Matrix15d h = link.h_to - link.h_cross.transpose() * solved;
  return StateQuadratic{.h = 0.5 * (h + h.transpose()),
                        .g = link.g_to - solved.transpose() * g,
                        .cost = state.cost + link.cost - 0.5 * g.dot(cholesky.solve<1>(g))};
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

std::optional<std::vector<Vector15d>> minimum(const ChainQuadratic& chain, double damping) {
  const size_t n = chain.states.size();
  const auto damped = [&](size_t i) {
    StateQuadratic state = chain.states[i];
    Vector15d diagonal = state.h.diagonal();
    diagonal += i > 0 ? Vector15d(chain.links[i - 1].h_to.diagonal()) : Vector15d::Zero();
    diagonal += i + 1 < n ? Vector15d(chain.links[i].h_from.diagonal()) : Vector15d::Zero();
    state.h.diagonal() += damping * diagonal;
    return state;
  };
  std::vector<StateQuadratic> forward = {damped(0)};
  for (size_t i = 0; i + 1 < n; ++i) {
    const std::optional<StateQuadratic> left = eliminated(forward[i], chain.links[i]);
    if (!left) {
      return std::nullopt;
    }
    forward.push_back(damped(i + 1));
    forward.back() += *left;
  }
  std::vector<Vector15d> steps(n, Vector15d::Zero());
  for (size_t i = n; i-- > 0;) {
    Matrix15d h = forward[i].h;
    Vector15d g = forward[i].g;
    if (i + 1 < n) {
      h += chain.links[i].h_from;
      g += chain.links[i].g_from + chain.links[i].h_cross * steps[i + 1];
    }
    const ScaledCholesky cholesky(h);
    if (!cholesky.regular()) {
      return std::nullopt;
    }
    steps[i] = -cholesky.solve<1>(g);
  }
  return steps;
}

}  // namespace adit
