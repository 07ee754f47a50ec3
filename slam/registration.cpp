// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "slam/registration.hpp"

#include <cmath>

#include "shaders/shared/registration.h"

namespace adit {

std::string_view to_string(RegistrationStatus status) {
  switch (status) {
    case RegistrationStatus::converged:
      return "converged";
    case RegistrationStatus::not_converged:
      return "not converged";
    case RegistrationStatus::too_little_overlap:
      return "too little overlap";
    case RegistrationStatus::too_few_points:
      return "too few points";
    case RegistrationStatus::diverged:
      return "diverged";
  }
  return "unknown";
}

gpu::mat3x4 to_device(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix<float, 3, 4> m = pose.matrix().topRows<3>().cast<float>();
  gpu::mat3x4 rows{};
  for (int i = 0; i < 3; ++i) {
    rows.rows[i] = {m(i, 0), m(i, 1), m(i, 2), m(i, 3)};
  }
  return rows;
}

Eigen::Isometry3d from_device(const gpu::mat3x4& rows) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 3; ++i) {
    const gpu::vec4& row = rows.rows[i];
    pose.matrix().row(i) << row.x, row.y, row.z, row.w;
  }
  return orthonormalized(pose);
}

RegistrationResult read_registration(const gpu::RegistrationState& state, int source_points,
                                     const RegistrationConfig& config) {
  RegistrationResult result;
  result.source_points = source_points;
  result.iterations = static_cast<int>(state.iterations);
  if (source_points == 0) {
    return result;
  }
  // The device perturbs in the target's axes about the source's origin: delta_target = diag(R, R)
  // delta_body.
  result.T_target_source = from_device(state.pose);
  Matrix6d to_target = Matrix6d::Zero();
  to_target.topLeftCorner<3, 3>() = result.T_target_source.linear();
  to_target.bottomRightCorner<3, 3>() = result.T_target_source.linear();
  Matrix6d h;
  Vector6d g;
  int k = 0;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) {
      h(i, j) = h(j, i) = static_cast<double>(state.system[k++]);
    }
  }
  for (int i = 0; i < 6; ++i) {
    g(i) = static_cast<double>(state.system[k++]);
  }
  const Matrix6d turned = to_target.transpose() * h * to_target;
  result.hessian = 0.5 * (turned + turned.transpose());  // symmetric to the last bit
  result.gradient = to_target.transpose() * g;
  result.cost = static_cast<double>(state.system[k++]);
  const double squared_distance = static_cast<double>(state.system[k++]);
  result.inliers = static_cast<int>(state.system[k]);
  result.residual_rms =
      result.inliers > 0 ? std::sqrt(std::max(squared_distance, 0.0) / result.inliers) : 0.0;
  result.overlap = static_cast<double>(result.inliers) / source_points;

  const bool finite = result.T_target_source.matrix().allFinite() && result.hessian.allFinite();
  if (result.inliers < config.min_inliers) {
    result.status = RegistrationStatus::too_few_points;
  } else if (state.failed != 0 || !finite) {
    result.status = RegistrationStatus::diverged;
  } else if (result.overlap < config.min_overlap) {
    result.status = RegistrationStatus::too_little_overlap;
  } else if (state.converged == 0) {
    result.status = RegistrationStatus::not_converged;
  } else {
    result.status = RegistrationStatus::converged;
  }
  return result;
}

}  // namespace adit
