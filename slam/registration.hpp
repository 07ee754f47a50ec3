// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "slam/config.hpp"
#include "slam/lie.hpp"

namespace adit::gpu {
struct RegistrationState;
struct mat3x4;
}  // namespace adit::gpu

namespace adit {

/// How an alignment ended. Only `converged` is a success; the others say why the pose is not to be
/// used.
enum class RegistrationStatus {
  converged,
  not_converged,       ///< still moving after max_iterations
  too_little_overlap,  ///< matched fraction below min_overlap
  too_few_points,      ///< matched points below min_inliers, or an empty source or target
  diverged,            ///< the step or the pose is not finite, or left the target's extent
};
std::string_view to_string(RegistrationStatus status);

/// Result of aligning a source cloud with a target. The Hessian and residuals are those at the
/// final pose.
struct RegistrationResult {
  Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();
  RegistrationStatus status = RegistrationStatus::too_few_points;
  Matrix6d hessian = Matrix6d::Zero();  ///< [rho, phi] of T_target_source, right perturbation;
                                        ///< 1/m^2, 1/(m rad), 1/rad^2
  Vector6d gradient = Vector6d::Zero();
  double cost = 0.0;  ///< sum of e^T Omega e over the inliers
  double residual_rms =
      0.0;  ///< m, root mean square distance along the target's normals over the inliers
  double overlap = 0.0;  ///< inliers / source points
  int inliers = 0;
  int source_points = 0;
  int iterations = 0;
};

/// The rows of a pose for the device (float32: the caller keeps it local), and back, rounded onto
/// SE(3).
gpu::mat3x4 to_device(const Eigen::Isometry3d& pose);
Eigen::Isometry3d from_device(const gpu::mat3x4& rows);

/// Reads what the device left of an alignment of `source_points` points and says how it ended.
/// T_target_source is the device's pose, in the target's local frame.
RegistrationResult read_registration(const gpu::RegistrationState& state, int source_points,
                                     const RegistrationConfig& config);

}  // namespace adit
