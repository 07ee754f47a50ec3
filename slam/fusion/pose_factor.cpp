// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/pose_factor.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "adit/slam/core/chi_squared.hpp"

namespace adit {
namespace {

// Information relative to the floor's below which a direction is unknown: rounding of float32 sums.
constexpr double kUnknown = 1e-6;
// The matches' cost is a quadratic no farther from where the alignment ended: half a voxel of the
// default size, and about as much at the usual range.
constexpr double kFarthest = 0.5;      // m
constexpr double kFarthestTurn = 0.1;  // rad

Vector6d bounded(const Vector6d& step) {
  const double size =
      std::max(step.head<3>().norm() / kFarthest, step.tail<3>().norm() / kFarthestTurn);
  return step / std::max(size, 1.0);
}

}  // namespace

double huber_width(int directions) {
  return std::sqrt(kChiSquared95[static_cast<size_t>(std::clamp(directions, 0, 6))]);
}

PoseMeasurement measured_pose(const RegistrationResult& alignment, const CovarianceModel& model,
                              const Eigen::Isometry3d& T_body_lidar) {
  const Eigen::Isometry3d T_lidar_body = T_body_lidar.inverse();
  Vector6d floor;
  floor << Eigen::Vector3d::Constant(model.sigma_translation),
      Eigen::Vector3d::Constant(model.sigma_rotation);
  // In units of the floor the covariance is inflation / eigenvalue + 1.
  const Matrix6d scaled = floor.asDiagonal() *
                          (alignment.information / inflation(alignment, model)) *
                          floor.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scaled);
  Vector6d roots = Vector6d::Zero();
  Vector6d to_optimum = Vector6d::Zero();  // of the matches alone, in units of the floor
  const Vector6d pull = floor.asDiagonal() * alignment.pull / inflation(alignment, model);
  PoseMeasurement measurement;
  for (int i = 0; i < 6; ++i) {
    const double information = eigen.eigenvalues()[i];
    if (information > kUnknown) {
      roots[i] = std::sqrt(information / (1.0 + information));
      const Vector6d direction = eigen.eigenvectors().col(i);
      to_optimum -= direction * direction.dot(pull) / information;
      ++measurement.known_directions;
    }
  }
  const Eigen::Isometry3d T_map_lidar =
      alignment.T_target_source * se3_exp(bounded(floor.asDiagonal() * to_optimum));
  measurement.T_map_body = T_map_lidar * T_lidar_body;
  measurement.root_information = roots.asDiagonal() * eigen.eigenvectors().transpose() *
                                 floor.cwiseInverse().asDiagonal() * adjoint(T_lidar_body);
  return measurement;
}

StateFactor<6> pose_factor(const PoseMeasurement& measurement, const NavState& state) {
  const Eigen::Matrix3d R_measured_map = measurement.T_map_body.linear().transpose();
  const Eigen::Matrix3d R_measured_body = R_measured_map * state.T_map_body.linear();
  Vector6d error;
  error << R_measured_map * (state.T_map_body.translation() - measurement.T_map_body.translation()),
      so3_log(R_measured_body);
  Matrix6d jacobian = Matrix6d::Zero();
  jacobian.topLeftCorner<3, 3>() = R_measured_body;
  jacobian.bottomRightCorner<3, 3>() = so3_right_jacobian_inverse(error.tail<3>());
  StateFactor<6> factor;
  factor.residual = measurement.root_information * error;
  factor.by_state.leftCols<6>() = measurement.root_information * jacobian;
  return factor;
}

}  // namespace adit
