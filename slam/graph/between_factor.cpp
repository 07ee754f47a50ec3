// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/between_factor.hpp"

#include <cmath>

namespace adit {
namespace {

/// q and -q are the same rotation; the one with the scalar part that is not negative is the short
/// way.
Eigen::Quaterniond short_quaternion(const Eigen::Matrix3d& rotation) {
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0.0) {
    q.coeffs() = -q.coeffs();
  }
  return q;
}

}  // namespace

BetweenResidual between_residual(const Eigen::Isometry3d& error, ResidualConvention convention) {
  BetweenResidual result;
  if (convention == ResidualConvention::logarithm) {
    result.residual = se3_log(error);
    result.by_error = se3_right_jacobian_inverse(result.residual);
    return result;
  }
  result.residual.head<3>() = error.translation();
  result.by_error.topLeftCorner<3, 3>() = error.linear();
  if (convention == ResidualConvention::rotation) {
    const Eigen::Vector3d phi = so3_log(error.linear());
    result.residual.tail<3>() = phi;
    result.by_error.bottomRightCorner<3, 3>() = so3_right_jacobian_inverse(phi);
  } else {
    const Eigen::Quaterniond q = short_quaternion(error.linear());
    result.residual.tail<3>() = q.vec();
    result.by_error.bottomRightCorner<3, 3>() =
        0.5 * (q.w() * Eigen::Matrix3d::Identity() + skew(q.vec()));
  }
  return result;
}

Matrix6d error_by_first(const Eigen::Isometry3d& T_i_j) {
  return -adjoint(T_i_j.inverse());
}

KernelValue apply(const RobustLoss& kernel, double chi2) {
  const double square = kernel.width * kernel.width;
  if (kernel.kernel == Kernel::pseudo_huber) {
    const double root = std::sqrt(1.0 + chi2 / square);
    return {2.0 * square * (root - 1.0), 1.0 / root, -0.5 / (square * root * root * root)};
  }
  if (kernel.kernel == Kernel::dcs && chi2 > square) {
    // The weight is the square of dynamic covariance scaling's s = 2 width^2 / (width^2 + chi2),
    // and the cost its integral, which rises everywhere, towards 3 width^2.
    const double sum = square + chi2;
    return {square * (3.0 * chi2 - square) / sum, 4.0 * square * square / (sum * sum),
            -8.0 * square * square / (sum * sum * sum)};
  }
  return {chi2, 1.0, 0.0};
}

}  // namespace adit
