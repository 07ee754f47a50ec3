// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/core/direction.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "adit/tests/support/numerical_jacobian.hpp"

namespace adit {
namespace {

class Direction : public testing::Test {
 protected:
  Eigen::Vector3d vector() {
    return Eigen::Vector3d::NullaryExpr([&] { return normal_(engine_); });
  }
  Eigen::Vector2d tangent(double size) {
    return Eigen::Vector2d::NullaryExpr([&] { return size * normal_(engine_); });
  }

 private:
  std::mt19937_64 engine_{5};
  std::normal_distribution<double> normal_;
};

TEST_F(Direction, TheBasisIsAcross) {
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d v = vector();
    const Eigen::Matrix<double, 3, 2> basis = across(v);
    EXPECT_LE((basis.transpose() * basis - Eigen::Matrix2d::Identity()).norm(), 1e-14);
    EXPECT_LE((basis.transpose() * v).norm(), 1e-14 * v.norm());
  }
}

TEST_F(Direction, TurnBetweenIsTheInverseOfTurned) {
  for (const double size : {0.0, 1e-8, 1e-4, 1e-3, 0.1, 0.8}) {
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d v = 9.8 * vector().normalized();
      const Eigen::Vector2d delta = tangent(size);
      const Eigen::Vector3d there = turned(v, delta);
      EXPECT_NEAR(there.norm(), 9.8, 1e-12);
      EXPECT_LE((turn_between(v, there) - delta).norm(), 1e-12 + 1e-11 * size) << size;
    }
  }
}

TEST_F(Direction, ItsJacobianEqualsNumericalDifferentiation) {
  for (const double size : {0.0, 1e-6, 5e-4, 2e-3, 0.1, 0.8}) {
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d from = vector();
      const Eigen::Vector3d to = turned(from, tangent(size));
      const auto numeric = test::numerical_jacobian<2, 2>(
          [&](const Eigen::Vector2d& d) { return turn_between(from, turned(to, d)); });
      EXPECT_LE((turn_between_by_to(from, to) - numeric).norm(), 1e-6) << size;
    }
  }
}

}  // namespace
}  // namespace adit
