// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Jacobians by central differences of fourth order: truncation stays below rounding.
#pragma once

#include <Eigen/Core>

namespace adit::test {

/// d f / d x at x = 0, where f takes a tangent vector of kColumns and gives a vector of kRows.
template <int kRows, int kColumns, class Function>
Eigen::Matrix<double, kRows, kColumns> numerical_jacobian(const Function& f, double step = 1e-3) {
  Eigen::Matrix<double, kRows, kColumns> jacobian;
  for (int i = 0; i < kColumns; ++i) {
    const auto at = [&](double x) -> Eigen::Matrix<double, kRows, 1> {
      return f(Eigen::Matrix<double, kColumns, 1>(x * Eigen::Matrix<double, kColumns, 1>::Unit(i)));
    };
    jacobian.col(i) =
        (8.0 * (at(step) - at(-step)) - (at(2.0 * step) - at(-2.0 * step))) / (12.0 * step);
  }
  return jacobian;
}

}  // namespace adit::test
