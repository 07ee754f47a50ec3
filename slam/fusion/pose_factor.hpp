// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adit/slam/fusion/linearization.hpp"
#include "adit/slam/registration/registration.hpp"

namespace adit {

/// A measured pose of the body, in square-root information form: what it does not know has rows of
/// zeros, and no covariance has to be made up for it.
struct PoseMeasurement {
  Eigen::Isometry3d T_map_body = Eigen::Isometry3d::Identity();
  /// Times [rho, phi] from the measured pose: the whitened residual.
  Matrix6d root_information = Matrix6d::Zero();
  int known_directions = 0;  ///< rows that are not zero
};

/// The pose that an alignment of a sweep measured. Its information is that of the matches, weakened
/// as `model` says: Sigma = inflation * information^-1 + floor, whose floors must be greater than
/// 0. Directions without information stay without. Where the alignment weighed a prior, the pose is
/// the one that the matches alone lead to: the measurement is independent of the prior.
PoseMeasurement measured_pose(const RegistrationResult& alignment, const CovarianceModel& model,
                              const Eigen::Isometry3d& T_body_lidar);

/// Rows of the measurement's eigenvectors, zero where it knows nothing.
StateFactor<6> pose_factor(const PoseMeasurement& measurement, const NavState& state);

/// Width of Huber's kernel for a measurement of that many directions: the square root of the chi
/// squared that 95 % stay below; 0 for none.
double huber_width(int directions);

}  // namespace adit
