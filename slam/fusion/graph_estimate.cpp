// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/fusion/graph_estimate.hpp"

#include <optional>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace adit {
namespace {

// The symmetric root of the information times the error, with metres and radians in comparable
// units.
Vector6d whitened(const Vector6d& error, const Matrix6d& information) {
  Vector6d unit;
  unit << Eigen::Vector3d::Ones(), Eigen::Vector3d::Constant(0.1);
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(unit.asDiagonal() * information *
                                                      unit.asDiagonal());
  const Vector6d roots = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return eigen.eigenvectors() * roots.asDiagonal() * eigen.eigenvectors().transpose() *
         unit.cwiseInverse().asDiagonal() * error;
}

/// None where the information is not positive, within rounding.
std::optional<StateMatrix> inverse(const StateMatrix& h) {
  const StateVector scale = h.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const StateMatrix unit = scale.asDiagonal() * h * scale.asDiagonal();
  const Eigen::LDLT<StateMatrix> factors = unit.ldlt();
  if (!(factors.vectorD().minCoeff() > 0.0)) {
    return std::nullopt;
  }
  const StateMatrix result =
      scale.asDiagonal() * factors.solve(StateMatrix::Identity()) * scale.asDiagonal();
  return 0.5 * (result + result.transpose());
}

}  // namespace

std::string_view to_string(GraphFailure failure) {
  switch (failure) {
    case GraphFailure::undetermined:
      return "undetermined";
    case GraphFailure::not_finite:
      return "not finite";
  }
  return "unknown";
}

Innovation innovation(const StateEstimate& prediction, const PoseMeasurement& measurement) {
  const StateFactor<6> factor = pose_factor(measurement, prediction.state);
  const Matrix6d covariance =
      Matrix6d::Identity() + factor.by_state * prediction.covariance * factor.by_state.transpose();
  NavState measured;
  measured.T_map_body = measurement.T_map_body;
  const Vector6d error = difference(measured, prediction.state).head<6>();
  const Matrix6d& root = measurement.root_information;
  return {.error = error,
          .nis = factor.residual.dot(covariance.ldlt().solve(factor.residual)),
          .degrees = measurement.known_directions,
          .whitened = whitened(error, root.transpose() * covariance.ldlt().solve(root))};
}

GraphEstimate estimated(StateEstimate estimate, const StateMatrix& information) {
  if (!information.allFinite() || !estimate.state.T_map_body.matrix().allFinite() ||
      !estimate.state.v_map_body.allFinite()) {
    return GraphFailure::not_finite;
  }
  const std::optional<StateMatrix> covariance = inverse(information);
  if (!covariance || !covariance->allFinite()) {
    return GraphFailure::undetermined;
  }
  estimate.covariance = *covariance;
  return estimate;
}

}  // namespace adit
