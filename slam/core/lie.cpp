// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/core/lie.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/SVD>

namespace adit {
namespace {

// Below this squared angle the closed forms lose digits to cancellation and the power series, cut
// where its next term is below double precision, take over.
constexpr double kSeriesSquaredAngle = 0.25;

/// (1 - cos(a)) / a^2 with t = a^2; the half-angle form does not cancel.
double cosine_coefficient(double angle) {
  if (angle < 1e-8) {
    return 0.5;
  }
  const double ratio = std::sin(0.5 * angle) / angle;
  return 2.0 * ratio * ratio;
}

/// (a - sin(a)) / a^3.
double sine_coefficient(double angle) {
  const double t = angle * angle;
  if (t > kSeriesSquaredAngle) {
    return (angle - std::sin(angle)) / (t * angle);
  }
  return 1.0 / 6.0 -
         t * (1.0 / 120.0 -
              t * (1.0 / 5040.0 -
                   t * (1.0 / 362880.0 - t * (1.0 / 39916800.0 - t * (1.0 / 6227020800.0)))));
}

/// (1 - (a/2) cot(a/2)) / a^2. The series has the coefficients |B_2n| / (2n)!.
double cotangent_coefficient(double angle) {
  const double t = angle * angle;
  if (t > kSeriesSquaredAngle) {
    return (1.0 - 0.5 * angle * std::cos(0.5 * angle) / std::sin(0.5 * angle)) / t;
  }
  return 1.0 / 12.0 +
         t * (1.0 / 720.0 +
              t * (1.0 / 30240.0 + t * (1.0 / 1209600.0 +
                                        t * (1.0 / 47900160.0 + t * (691.0 / 1307674368000.0 +
                                                                     t * (1.0 / 74724249600.0))))));
}

/// d cotangent_coefficient / d a, divided by a. The series is the derivative of the one above.
double cotangent_slope(double angle) {
  const double t = angle * angle;
  if (t > kSeriesSquaredAngle) {
    const double half = 0.5 * angle;
    const double sine = std::sin(half);
    const double slope = 0.5 * std::cos(half) / sine - 0.5 * half / (sine * sine);
    return -(slope / angle + 2.0 * cotangent_coefficient(angle)) / t;
  }
  return 2.0 * (1.0 / 720.0 + t * (2.0 / 30240.0 +
                                   t * (3.0 / 1209600.0 +
                                        t * (4.0 / 47900160.0 + t * (5.0 * 691.0 / 1307674368000.0 +
                                                                     t * (6.0 / 74724249600.0))))));
}

/// The quaternion of a rotation matrix with a scalar part that is not negative.
Eigen::Quaterniond short_quaternion(const Eigen::Matrix3d& rotation) {
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0.0) {
    q.coeffs() = -q.coeffs();
  }
  return q;
}

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(),  //
      v.z(), 0.0, -v.x(),   //
      -v.y(), v.x(), 0.0;
  return m;
}

Eigen::Matrix3d so3_exp(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const double scale = angle < 1e-8 ? 0.5 : std::sin(0.5 * angle) / angle;
  const Eigen::Vector3d v = scale * phi;
  return Eigen::Quaterniond(std::cos(0.5 * angle), v.x(), v.y(), v.z())
      .normalized()
      .toRotationMatrix();
}

Eigen::Vector3d so3_log(const Eigen::Matrix3d& rotation) {
  // atan2 of the quaternion's parts is accurate at every angle; acos of the trace is not, at 0 and
  // at pi.
  const Eigen::Quaterniond q = short_quaternion(rotation);
  const double sine = q.vec().norm();
  if (sine < 1e-8) {
    return (2.0 / q.w()) * q.vec();
  }
  return (2.0 * std::atan2(sine, q.w()) / sine) * q.vec();
}

Eigen::Matrix3d so3_right_jacobian(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const Eigen::Matrix3d w = skew(phi);
  return Eigen::Matrix3d::Identity() - cosine_coefficient(angle) * w +
         sine_coefficient(angle) * w * w;
}

Eigen::Matrix3d so3_right_jacobian_inverse(const Eigen::Vector3d& phi) {
  const Eigen::Matrix3d w = skew(phi);
  return Eigen::Matrix3d::Identity() + 0.5 * w + cotangent_coefficient(phi.norm()) * w * w;
}

Eigen::Isometry3d se3_exp(const Vector6d& xi) {
  const Eigen::Vector3d phi = xi.tail<3>();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = so3_exp(phi);
  // The left Jacobian at phi is the right one at -phi.
  pose.translation() = so3_right_jacobian(-phi) * xi.head<3>();
  return pose;
}

Vector6d se3_log(const Eigen::Isometry3d& pose) {
  const Eigen::Vector3d phi = so3_log(pose.linear());
  Vector6d xi;
  xi << so3_right_jacobian_inverse(-phi) * pose.translation(), phi;
  return xi;
}

Matrix6d se3_right_jacobian_inverse(const Vector6d& xi) {
  // With t = J_l(phi) rho the logarithm's first part is rho = J_l(phi)^-1 t, and what a rotation of
  // the pose on the right does to it is the derivative of that by phi.
  const Eigen::Vector3d phi = xi.tail<3>();
  const Eigen::Vector3d t = so3_right_jacobian(-phi) * xi.head<3>();
  const Eigen::Vector3d once = phi.cross(t);
  const Eigen::Vector3d twice = phi.cross(once);
  const double angle = phi.norm();
  const Eigen::Matrix3d by_phi = 0.5 * skew(t) -
                                 cotangent_coefficient(angle) * (skew(once) + skew(phi) * skew(t)) +
                                 cotangent_slope(angle) * twice * phi.transpose();
  const Eigen::Matrix3d rotation = so3_right_jacobian_inverse(phi);
  Matrix6d result = Matrix6d::Zero();
  result.topLeftCorner<3, 3>() = rotation;
  result.topRightCorner<3, 3>() = by_phi * rotation;
  result.bottomRightCorner<3, 3>() = rotation;
  return result;
}

Eigen::Isometry3d retract(const Eigen::Isometry3d& pose, const Vector6d& xi) {
  Eigen::Isometry3d moved = pose;
  moved.translation() += pose.linear() * xi.head<3>();
  moved.linear() = pose.linear() * so3_exp(xi.tail<3>());
  return moved;
}

Matrix6d adjoint(const Eigen::Isometry3d& pose) {
  Matrix6d result = Matrix6d::Zero();
  result.topLeftCorner<3, 3>() = pose.linear();
  result.topRightCorner<3, 3>() = skew(pose.translation()) * pose.linear();
  result.bottomRightCorner<3, 3>() = pose.linear();
  return result;
}

Matrix6d symmetric_inverse(const Matrix6d& matrix) {
  const Matrix6d inverse = matrix.ldlt().solve(Matrix6d::Identity());
  return 0.5 * (inverse + inverse.transpose());
}

Eigen::Isometry3d pose_of(const std::array<double, 7>& numbers) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(numbers[6], numbers[3], numbers[4], numbers[5])
                      .normalized()
                      .toRotationMatrix();
  pose.translation() << numbers[0], numbers[1], numbers[2];
  return pose;
}

std::array<double, 7> numbers_of(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const Eigen::Vector3d& t = pose.translation();
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

double rotation_angle(const Eigen::Matrix3d& rotation) {
  const Eigen::Quaterniond q = short_quaternion(rotation);
  return 2.0 * std::atan2(q.vec().norm(), q.w());
}

Eigen::Isometry3d orthonormalized(const Eigen::Isometry3d& pose) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(pose.linear(),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0.0) {
    u.col(2) = -u.col(2);
  }
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = u * svd.matrixV().transpose();
  result.translation() = pose.translation();
  return result;
}

}  // namespace adit
