// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Elementary functions from sums, products and square roots alone, which IEEE 754 fixes to the last
// bit. Those of the C library differ between its versions and between processors (it has variants
// with fused products), so a simulation that used them would not give the same bytes everywhere.
#pragma once

#include <Eigen/Core>

namespace adit {

struct SinCos {
  double sin = 0.0;
  double cos = 1.0;
};

/// Sine and cosine of an angle (rad) of at most 1e6; the error is below 4e-16 times the larger of 1
/// and 1e-3 of the angle.
SinCos repeatable_sin_cos(double angle);

/// The angle (rad, -pi to pi) of the direction (x, y), as std::atan2. Error below 1e-15.
double repeatable_atan2(double y, double x);

/// Natural logarithm of a positive, normal number. Relative error below 1e-15.
double repeatable_log(double x);

/// e to the power x; 0 below -700, |x| <= 700 otherwise. Relative error below 1e-14.
double repeatable_exp(double x);

/// Exponential map of SO(3), as so3_exp().
Eigen::Matrix3d repeatable_so3_exp(const Eigen::Vector3d& phi);

/// Logarithm of SO(3) for angles below pi, as so3_log().
Eigen::Vector3d repeatable_so3_log(const Eigen::Matrix3d& rotation);

/// Rz(yaw) Ry(pitch) Rx(roll), radians.
Eigen::Matrix3d rotation_from_yaw_pitch_roll(double yaw, double pitch, double roll);

}  // namespace adit
