// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/between_factor.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "adit/tests/support/numerical_jacobian.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

Vector6d random_vector(Random& random, double size) {
  return Vector6d::NullaryExpr([&] { return random.uniform(-size, size); });
}

/// Errors from none at all to half a turn.
std::vector<Eigen::Isometry3d> errors(Random& random) {
  std::vector<Eigen::Isometry3d> result = {Eigen::Isometry3d::Identity()};
  for (const double size : {1e-8, 1e-3, 0.3, 1.7}) {
    for (int i = 0; i < 5; ++i) {
      result.push_back(se3_exp(random_vector(random, size)));
    }
  }
  return result;
}

class Between : public testing::TestWithParam<ResidualConvention> {};

TEST_P(Between, JacobianByTheErrorIsTheNumericalOne) {
  Random random(1);
  for (const Eigen::Isometry3d& error : errors(random)) {
    const BetweenResidual at = between_residual(error, GetParam());
    const Matrix6d numerical = test::numerical_jacobian<6, 6>([&](const Vector6d& xi) {
      return between_residual(retract(error, xi), GetParam()).residual;
    });
    EXPECT_LT((at.by_error - numerical).cwiseAbs().maxCoeff(), 2e-9) << error.matrix();
  }
}

TEST_P(Between, JacobiansByTheNodesAreTheNumericalOnes) {
  Random random(2);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Isometry3d first = se3_exp(random_vector(random, 2.0));
    const Eigen::Isometry3d second = se3_exp(random_vector(random, 2.0));
    const Eigen::Isometry3d back =
        se3_exp(random_vector(random, 0.4)) * (first.inverse() * second).inverse();
    const auto residual = [&](const Vector6d& xi_first, const Vector6d& xi_second) {
      return between_residual(
                 back * retract(first, xi_first).inverse() * retract(second, xi_second), GetParam())
          .residual;
    };
    const Matrix6d by_error =
        between_residual(back * first.inverse() * second, GetParam()).by_error;
    const Matrix6d by_first = test::numerical_jacobian<6, 6>(
        [&](const Vector6d& xi) { return residual(xi, Vector6d::Zero()); });
    const Matrix6d by_second = test::numerical_jacobian<6, 6>(
        [&](const Vector6d& xi) { return residual(Vector6d::Zero(), xi); });
    EXPECT_LT(
        (by_error * error_by_first(first.inverse() * second) - by_first).cwiseAbs().maxCoeff(),
        2e-9);
    EXPECT_LT((by_error - by_second).cwiseAbs().maxCoeff(), 2e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Conventions, Between,
                         testing::Values(ResidualConvention::quaternion,
                                         ResidualConvention::rotation,
                                         ResidualConvention::logarithm));

TEST(BetweenResiduals, AgreeForSmallErrorsButForTheRotationsScale) {
  Vector6d small;
  small << 1e-4, -2e-4, 3e-4, 2e-4, 1e-4, -1e-4;
  const Eigen::Isometry3d error = se3_exp(small);
  const Vector6d log = between_residual(error, ResidualConvention::logarithm).residual;
  Vector6d half = between_residual(error, ResidualConvention::quaternion).residual;
  half.tail<3>() *= 2.0;
  EXPECT_LT((log - small).norm(), 1e-12);
  EXPECT_LT((between_residual(error, ResidualConvention::rotation).residual - small).norm(), 1e-7);
  EXPECT_LT((half - small).norm(), 1e-7);
}

// A closed form and a series meet at an angle of a half.
TEST(BetweenResiduals, JacobianOfTheLogarithmHasNoStepWhereItsSeriesEnds) {
  const Vector6d direction = (Vector6d() << 0.3, -0.2, 0.5, 0.36, 0.48, 0.8).finished();
  const auto at = [&](double angle) {
    Vector6d xi = direction;
    xi.tail<3>() *= angle;
    return se3_right_jacobian_inverse(xi);
  };
  EXPECT_LT((at(0.5 + 1e-12) - at(0.5 - 1e-12)).cwiseAbs().maxCoeff(), 1e-11);
  const Vector6d xi = (Vector6d() << 1.0, 2.0, -0.5, 0.7, -0.9, 1.1).finished();
  const Matrix6d numerical = test::numerical_jacobian<6, 6>(
      [&](const Vector6d& d) { return se3_log(se3_exp(xi) * se3_exp(d)); });
  EXPECT_LT((se3_right_jacobian_inverse(xi) - numerical).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(RobustKernels, DerivativesAreTheNumericalOnesAndCostsRise) {
  for (const Kernel kernel : {Kernel::none, Kernel::pseudo_huber, Kernel::dcs}) {
    const RobustLoss robust{kernel, 3.0};
    double before = apply(robust, 0.0).cost;
    EXPECT_DOUBLE_EQ(apply(robust, 0.0).weight, 1.0);
    for (const double chi2 : {0.1, 4.0, 8.9, 9.1, 20.0, 400.0, 1e5}) {
      const double step = 1e-4 * chi2;
      const double up = apply(robust, chi2 + step).cost;
      const double down = apply(robust, chi2 - step).cost;
      const KernelValue value = apply(robust, chi2);
      EXPECT_NEAR(value.weight, (up - down) / (2.0 * step), 1e-6);
      EXPECT_NEAR(
          value.curvature,
          (apply(robust, chi2 + step).weight - apply(robust, chi2 - step).weight) / (2.0 * step),
          1e-6);
      EXPECT_GT(value.cost, before);
      before = value.cost;
    }
  }
  EXPECT_DOUBLE_EQ(apply({Kernel::dcs, 3.0}, 8.0).cost, 8.0);  // exact up to the width
  EXPECT_LT(apply({Kernel::dcs, 3.0}, 1e12).cost, 27.0);
}

}  // namespace
}  // namespace adit
