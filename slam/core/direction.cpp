// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/core/direction.hpp"

#include <cmath>

#include "adit/slam/core/lie.hpp"

namespace adit {
namespace {

// Below this angle series are exact to rounding.
constexpr double kSmallAngle = 1e-3;  // rad
// The basis follows x up to here, so that it hardly turns where a direction moves a little, near
// the vertical above all.
constexpr double kSteep = 0.8;

// With m = n0 x n, |m| = sin and n0 n = cos, the rotation vector is ratio(...) m.
double ratio(double sine, double cosine) {
  const double angle = std::atan2(sine, cosine);
  return angle < kSmallAngle ? 1.0 + angle * angle / 6.0 : angle / sine;
}

}  // namespace

Eigen::Matrix<double, 3, 2> across(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d n = direction.normalized();
  const Eigen::Vector3d axis =
      std::abs(n.x()) < kSteep ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = (axis - axis.dot(n) * n).normalized();
  basis.col(1) = n.cross(basis.col(0));
  return basis;
}

Eigen::Vector3d turned(const Eigen::Vector3d& direction, const Eigen::Vector2d& delta) {
  return so3_exp(across(direction) * delta) * direction;
}

Eigen::Vector2d turn_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d m = from.normalized().cross(to.normalized());
  const double cosine = from.normalized().dot(to.normalized());
  return across(from).transpose() * (ratio(m.norm(), cosine) * m);
}

// With n = to / |to| and e at it: dn = -[n]x across(n) e, and of r = f(sin, cos) m, m = n0 x n:
// dr = f dm - k m (n0 dn), k = (sin - angle cos) / sin^3.
Eigen::Matrix2d turn_between_by_to(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d n0 = from.normalized();
  const Eigen::Vector3d n = to.normalized();
  const Eigen::Vector3d m = n0.cross(n);
  const double sine = m.norm();
  const double cosine = n0.dot(n);
  const double angle = std::atan2(sine, cosine);
  const double k = angle < kSmallAngle ? 1.0 / 3.0 : (sine - angle * cosine) / (sine * sine * sine);
  const Eigen::Matrix3d by_n = ratio(sine, cosine) * skew(n0) - k * m * n0.transpose();
  return across(from).transpose() * by_n * -skew(n) * across(to);
}

}  // namespace adit
