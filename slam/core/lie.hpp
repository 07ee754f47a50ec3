// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// SO(3) and SE(3) over Eigen, in the one convention of the project: tangent vectors are ordered
// translation first, then rotation, xi = [rho, phi]; perturbations act on the right (body):
//   R <- R Exp(phi),  p <- p + R rho.
// shaders/include/lie.glsl holds the same convention for the device.
#pragma once

#include <array>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace adit {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// [v]x, so that skew(a) * b = a x b.
Eigen::Matrix3d skew(const Eigen::Vector3d& v);

/// Exponential map of SO(3); phi in radians. Exact to machine precision down to |phi| = 0.
Eigen::Matrix3d so3_exp(const Eigen::Vector3d& phi);

/// Logarithm of SO(3), |phi| <= pi (radians).
Eigen::Vector3d so3_log(const Eigen::Matrix3d& rotation);

/// Right Jacobian of SO(3): Exp(phi + d) ~ Exp(phi) Exp(J d).
Eigen::Matrix3d so3_right_jacobian(const Eigen::Vector3d& phi);

/// Inverse of so3_right_jacobian().
Eigen::Matrix3d so3_right_jacobian_inverse(const Eigen::Vector3d& phi);

/// Full exponential map of SE(3), xi = [rho, phi] (m, rad).
Eigen::Isometry3d se3_exp(const Vector6d& xi);

/// Full logarithm of SE(3), [rho, phi] (m, rad).
Vector6d se3_log(const Eigen::Isometry3d& pose);

/// Inverse of SE(3)'s right Jacobian: Log(Exp(xi) Exp(d)) ~ xi + J d.
Matrix6d se3_right_jacobian_inverse(const Vector6d& xi);

/// The solvers' retraction (SO(3) x R3): R Exp(phi), p + R rho.
Eigen::Isometry3d retract(const Eigen::Isometry3d& pose, const Vector6d& xi);

/// Adjoint for [rho, phi]: T Exp(xi) T^-1 = Exp(Ad(T) xi).
Matrix6d adjoint(const Eigen::Isometry3d& pose);

/// Of a symmetric positive definite matrix, symmetric to the last bit: a covariance of an
/// information matrix, and the other way round.
Matrix6d symmetric_inverse(const Matrix6d& matrix);

/// The pose that is written x y z qx qy qz qw; the quaternion is normalised.
Eigen::Isometry3d pose_of(const std::array<double, 7>& numbers);
/// The numbers that pose_of() reads.
std::array<double, 7> numbers_of(const Eigen::Isometry3d& pose);

/// Rotation angle of a rotation matrix, radians in [0, pi].
double rotation_angle(const Eigen::Matrix3d& rotation);

/// The nearest rotation (in the Frobenius norm) to a matrix that has drifted off SO(3).
Eigen::Isometry3d orthonormalized(const Eigen::Isometry3d& pose);

}  // namespace adit
