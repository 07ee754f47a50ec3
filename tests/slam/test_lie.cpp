// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/core/lie.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace adit {
namespace {

constexpr double kPi = std::numbers::pi;

/// Rotation vectors in every regime of the formulas: zero, tiny, on both sides of the series'
/// limit, random, near pi.
std::vector<Eigen::Vector3d> rotation_vectors() {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector3d> vectors = {Eigen::Vector3d::Zero()};
  for (const double angle : {1e-300, 1e-160, 1e-12, 1e-8, 3e-5, 1e-3, 0.4999999, 0.5000001, 1.0,
                             2.0, 3.0, kPi - 1e-4, kPi - 1e-9}) {
    for (int i = 0; i < 4; ++i) {
      vectors.emplace_back(
          angle * Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized());
    }
    vectors.emplace_back(angle * Eigen::Vector3d::UnitX());
    vectors.emplace_back(-angle * Eigen::Vector3d::UnitZ());
  }
  return vectors;
}

std::vector<Vector6d> twists() {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  std::vector<Vector6d> result;
  for (const Eigen::Vector3d& phi : rotation_vectors()) {
    Vector6d xi;
    xi << 5.0 * normal(random), normal(random), 20.0 * normal(random), phi;
    result.push_back(xi);
  }
  return result;
}

/// The exponential's power series in long double, which shares no formula with the code.
Eigen::Matrix3d series_exp(const Eigen::Vector3d& phi) {
  using Matrix = Eigen::Matrix<long double, 3, 3>;
  const Matrix w = skew(phi).cast<long double>();
  Matrix term = Matrix::Identity();
  Matrix sum = term;
  for (int n = 1; n < 60; ++n) {
    term = (term * w / static_cast<long double>(n)).eval();
    sum += term;
  }
  return sum.cast<double>();
}

/// Integral of the exponential of s phi over s in [0, 1], the left Jacobian, in long double.
Eigen::Matrix3d series_left_jacobian(const Eigen::Vector3d& phi) {
  using Matrix = Eigen::Matrix<long double, 3, 3>;
  const Matrix w = skew(phi).cast<long double>();
  Matrix term = Matrix::Identity();
  Matrix sum = term;
  for (int n = 1; n < 60; ++n) {
    term = (term * w / static_cast<long double>(n + 1)).eval();
    sum += term;
  }
  return sum.cast<double>();
}

TEST(Lie, SkewIsTheCrossProduct) {
  const Eigen::Vector3d a(1.0, -2.0, 3.0);
  const Eigen::Vector3d b(0.3, 0.7, -1.1);
  EXPECT_TRUE((skew(a) * b).isApprox(a.cross(b), 1e-15));
  EXPECT_EQ(skew(a).transpose(), -skew(a));
}

TEST(Lie, ExpEqualsItsPowerSeries) {
  for (const Eigen::Vector3d& phi : rotation_vectors()) {
    EXPECT_LT((so3_exp(phi) - series_exp(phi)).cwiseAbs().maxCoeff(), 2e-15) << phi.transpose();
  }
}

TEST(Lie, ExpIsARotation) {
  for (const Eigen::Vector3d& phi : rotation_vectors()) {
    const Eigen::Matrix3d r = so3_exp(phi);
    EXPECT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 2e-15);
    EXPECT_NEAR(r.determinant(), 1.0, 2e-15);
  }
}

TEST(Lie, LogUndoesExp) {
  for (const Eigen::Vector3d& phi : rotation_vectors()) {
    const Eigen::Vector3d back = so3_log(so3_exp(phi));
    // A matrix cannot hold an angle below about 1e-16 better than absolutely.
    EXPECT_LT((back - phi).norm(), 4e-15) << phi.transpose();
  }
}

TEST(Lie, SmallAnglesKeepTheirRelativePrecision) {
  const Eigen::Vector3d phi(1e-8, -2e-8, 3e-8);
  EXPECT_LT((so3_log(so3_exp(phi)) - phi).norm(), 1e-15 * phi.norm() * 10.0);
}

TEST(Lie, LogAtPiHasLengthPi) {
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, -1, 0),
                                      Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(-3, 2, 0.1)}) {
    const Eigen::Matrix3d half_turn =
        2.0 * axis.normalized() * axis.normalized().transpose() - Eigen::Matrix3d::Identity();
    EXPECT_NEAR(so3_log(half_turn).norm(), kPi, 1e-14);
    EXPECT_LT((so3_exp(so3_log(half_turn)) - half_turn).cwiseAbs().maxCoeff(), 1e-14);
  }
}

TEST(Lie, RotationAngleIsTheLengthOfTheLog) {
  for (const Eigen::Vector3d& phi : rotation_vectors()) {
    EXPECT_NEAR(rotation_angle(so3_exp(phi)), phi.norm(), 4e-15);
  }
}

TEST(Lie, RightJacobianEqualsItsPowerSeries) {
  for (const Eigen::Vector3d& phi : rotation_vectors()) {
    EXPECT_LT((so3_right_jacobian(phi) - series_left_jacobian(-phi)).cwiseAbs().maxCoeff(), 3e-15)
        << phi.transpose();
  }
}

TEST(Lie, RightJacobianIsTheDerivativeOfExp) {
  constexpr double kStep = 1e-5;
  for (const Eigen::Vector3d& phi : rotation_vectors()) {
    Eigen::Matrix3d numeric;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(i);
      const Eigen::Matrix3d base = so3_exp(phi).transpose();
      numeric.col(i) =
          (so3_log(base * so3_exp(phi + d)) - so3_log(base * so3_exp(phi - d))) / (2.0 * kStep);
    }
    EXPECT_LT((numeric - so3_right_jacobian(phi)).cwiseAbs().maxCoeff(), 1e-9) << phi.transpose();
  }
}

TEST(Lie, RightJacobianInverseIsTheInverse) {
  for (const Eigen::Vector3d& phi : rotation_vectors()) {
    const Eigen::Matrix3d product = so3_right_jacobian(phi) * so3_right_jacobian_inverse(phi);
    EXPECT_LT((product - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-14)
        << phi.transpose();
  }
}

TEST(Lie, Se3LogUndoesExp) {
  for (const Vector6d& xi : twists()) {
    EXPECT_LT((se3_log(se3_exp(xi)) - xi).norm(), 1e-13) << xi.transpose();
  }
}

TEST(Lie, Se3ExpOfAScrewIsItsPowers) {
  // Exp(2 xi) = Exp(xi)^2 holds for the full exponential and not for the decoupled retraction.
  for (const Vector6d& xi : twists()) {
    const Eigen::Isometry3d once = se3_exp(0.5 * xi);
    EXPECT_LT(((once * once).matrix() - se3_exp(xi).matrix()).cwiseAbs().maxCoeff(), 1e-13);
  }
}

TEST(Lie, AdjointMovesATwistToTheOtherSide) {
  const std::vector<Vector6d> all = twists();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Eigen::Isometry3d pose = se3_exp(all[all.size() - 1 - i]);
    const Vector6d xi = 0.1 * all[i];
    const Eigen::Isometry3d left = pose * se3_exp(xi) * pose.inverse();
    const Eigen::Isometry3d right = se3_exp(adjoint(pose) * xi);
    EXPECT_LT((left.matrix() - right.matrix()).cwiseAbs().maxCoeff(), 1e-11);
  }
}

TEST(Lie, RetractIsTheExponentialToFirstOrder) {
  const Eigen::Isometry3d pose = se3_exp(twists().back());
  Vector6d xi;
  xi << 1.0, -2.0, 0.5, 0.3, -0.2, 0.9;
  const auto difference = [&](double h) {
    return (retract(pose, h * xi).matrix() - (pose * se3_exp(h * xi)).matrix()).norm();
  };
  // Halving the step quarters what is left.
  EXPECT_NEAR(difference(1e-3) / difference(5e-4), 4.0, 0.01);
}

TEST(Lie, RetractMovesTranslationInBodyAxes) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = so3_exp(Eigen::Vector3d(0.0, 0.0, kPi / 2.0));
  Vector6d xi = Vector6d::Zero();
  xi(0) = 1.0;
  EXPECT_TRUE(retract(pose, xi).translation().isApprox(Eigen::Vector3d::UnitY(), 1e-15));
}

TEST(Lie, OrthonormalizedFindsTheNearestRotation) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 1e-3);
  for (const Vector6d& xi : twists()) {
    Eigen::Isometry3d pose = se3_exp(xi);
    pose.linear() += Eigen::Matrix3d::NullaryExpr([&] { return noise(random); });
    const Eigen::Isometry3d result = orthonormalized(pose);
    EXPECT_LT((result.linear() * result.linear().transpose() - Eigen::Matrix3d::Identity())
                  .cwiseAbs()
                  .maxCoeff(),
              4e-15);
    EXPECT_GT(result.linear().determinant(), 0.0);
    EXPECT_EQ(result.translation(), pose.translation());
    // Nearest: what is left is symmetric in the rotation's own axes.
    const Eigen::Matrix3d rest = result.linear().transpose() * pose.linear();
    EXPECT_LT((rest - rest.transpose()).cwiseAbs().maxCoeff(), 1e-14);
  }
}

TEST(Lie, OrthonormalizedNeverMirrors) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear().diagonal() << 1.0, 1.0, -0.1;
  EXPECT_NEAR(orthonormalized(pose).linear().determinant(), 1.0, 1e-15);
}

TEST(Lie, APoseIsReadBackFromItsNumbers) {
  Vector6d xi;
  xi << 1.0, -2.0, 3.0, 0.4, -2.1, 1.3;
  const Eigen::Isometry3d pose = se3_exp(xi);
  EXPECT_LE((pose_of(numbers_of(pose)).matrix() - pose.matrix()).norm(), 1e-14);
  // A quaternion of any length.
  EXPECT_TRUE(pose_of({1.0, 2.0, 3.0, 0.0, 0.0, 2.0, 2.0})
                  .linear()
                  .isApprox(so3_exp({0.0, 0.0, 0.5 * kPi}), 1e-14));
}

}  // namespace
}  // namespace adit
