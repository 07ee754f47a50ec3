// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/registration/registration.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "adit/shaders/shared/registration.h"

namespace adit {

std::string_view to_string(RegistrationStatus status) {
  switch (status) {
    case RegistrationStatus::converged:
      return "converged";
    case RegistrationStatus::degenerate:
      return "degenerate";
    case RegistrationStatus::not_converged:
      return "not converged";
    case RegistrationStatus::too_little_overlap:
      return "too little overlap";
    case RegistrationStatus::too_few_points:
      return "too few points";
    case RegistrationStatus::diverged:
      return "diverged";
    case RegistrationStatus::doubtful:
      return "doubtful";
  }
  return "unknown";
}

std::string_view to_string(Localizability localizability) {
  switch (localizability) {
    case Localizability::full:
      return "full";
    case Localizability::partial:
      return "partial";
    case Localizability::none:
      return "none";
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

namespace {

constexpr double kOutliers = 0.55;  // part of the points that NDT's score takes for outliers

Matrix6d symmetric(const float* upper) {
  Matrix6d m;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) {
      m(i, j) = m(j, i) = static_cast<double>(*upper++);
    }
  }
  return m;
}

// Sum of w J^T J over the matches, from the sums that gpu::kGeometryAt describes.
Matrix6d identity_information(const float* sums) {
  const Eigen::Map<const Eigen::Matrix<float, 16, 1>> raw(sums);
  const Eigen::Matrix<double, 16, 1> s = raw.cast<double>();
  Eigen::Matrix3d outer;
  outer << s(4), s(5), s(6), s(5), s(7), s(8), s(6), s(8), s(9);
  Matrix6d g;
  g.topLeftCorner<3, 3>() = s(0) * Eigen::Matrix3d::Identity();
  g.topRightCorner<3, 3>() = -skew(s.segment<3>(1));
  g.bottomLeftCorner<3, 3>() = g.topRightCorner<3, 3>().transpose();
  g.bottomRightCorner<3, 3>() = outer.trace() * Eigen::Matrix3d::Identity() - outer;
  return g;
}

// Leaves `share` of the information on moving along u when all else gives way to it.
Matrix6d weakened(const Matrix6d& h, const Vector6d& u, double share) {
  const Vector6d hu = h * u;
  const double curvature = u.dot(hu);
  return curvature > 0.0 ? Matrix6d(h - (1.0 - share) / curvature * hu * hu.transpose()) : h;
}

Vector6d giving_way(const Matrix6d& h, const Eigen::Vector3d& axis, int at) {
  const int other = 3 - at;
  const Eigen::Matrix3d block = h.block<3, 3>(other, other);
  const Eigen::Matrix3d ridge = (1e-9 * block.trace() + 1e-300) * Eigen::Matrix3d::Identity();
  Vector6d u;
  u.segment<3>(at) = axis;
  u.segment<3>(other) = -(block + ridge).ldlt().solve(h.block<3, 3>(other, at) * axis);
  return u;
}

Localizability class_of(double share) {
  return share <= 0.0 ? Localizability::none
                      : (share < 1.0 ? Localizability::partial : Localizability::full);
}

// The gradient without what regularised covariances pull with in every direction; target axes.
Vector6d geometric_gradient(const gpu::RegistrationState& state, double fictitious) {
  const Eigen::Map<const Eigen::Matrix<float, 6, 1>> whole(state.system + 21);
  const Eigen::Map<const Eigen::Matrix<float, 6, 1>> drift(state.system + gpu::kGeometryAt + 10);
  return whole.cast<double>() + fictitious * drift.cast<double>();
}

// The directions, and the information with the weak ones taken out; target axes.
void read_directions(const gpu::RegistrationState& state, const Matrix6d& geometric,
                     RegistrationResult& result) {
  Matrix6d information = geometric;
  for (int k = 0; k < 6; ++k) {
    const gpu::vec4& raw = state.directions[k];
    const Eigen::Vector3d axis = Eigen::Vector3f(raw.x, raw.y, raw.z).cast<double>().normalized();
    ObservedDirection& direction = k < 3 ? result.translation[static_cast<size_t>(k)]
                                         : result.rotation[static_cast<size_t>(k - 3)];
    const double share = static_cast<double>(state.share[k]);
    direction.axis = result.T_target_source.linear().transpose() * axis;
    direction.localizability = class_of(share);
    direction.information = static_cast<double>(raw.w);
    direction.support = static_cast<double>(state.support[k].x);
    direction.information_each = static_cast<double>(state.support[k].y);
    if (share < 1.0 && state.constrained != gpu::kWithPrior) {
      information = weakened(information, giving_way(information, axis, k < 3 ? 0 : 3), share);
    }
  }
  result.information = information;
}

bool has_none(const RegistrationResult& result) {
  const auto none = [](const ObservedDirection& direction) {
    return direction.localizability == Localizability::none;
  };
  return std::any_of(result.translation.begin(), result.translation.end(), none) ||
         std::any_of(result.rotation.begin(), result.rotation.end(), none);
}

// diag(R, R).
Matrix6d axes(const Eigen::Matrix3d& rotation) {
  Matrix6d both = Matrix6d::Zero();
  both.topLeftCorner<3, 3>() = rotation;
  both.bottomRightCorner<3, 3>() = rotation;
  return both;
}

Matrix6d turned(const Matrix6d& m, const Matrix6d& to_target) {
  const Matrix6d t = to_target.transpose() * m * to_target;
  return 0.5 * (t + t.transpose());  // symmetric to the last bit
}

}  // namespace

gpu::RegistrationState initial_state(const Eigen::Isometry3d& guess,
                                     const Matrix6d& prior_information, bool weighed) {
  gpu::RegistrationState state{};
  state.constrained = weighed ? gpu::kWithPrior : gpu::kUnconstrained;
  state.pose = to_device(guess);
  state.guess = state.pose;
  const Matrix6d prior = turned(prior_information, axes(guess.linear().transpose()));
  size_t k = 0;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) {
      state.prior[k++] = static_cast<float>(prior(i, j));
    }
  }
  return state;
}

NdtScore ndt_score(double voxel_size) {
  const double c1 = 10.0 * (1.0 - kOutliers);
  const double c2 = kOutliers / (voxel_size * voxel_size * voxel_size);
  const double d3 = -std::log(c2);
  const double d1 = -std::log(c1 + c2) - d3;
  const double d2 = -2.0 * std::log((-std::log(c1 * std::exp(-0.5) + c2) - d3) / d1);
  return {.weight = -d1 * d2, .exponent = 0.5 * d2};
}

RegistrationResult read_registration(const DeviceAlignment& device, int source_points,
                                     double fictitious, const RegistrationConfig& config) {
  const gpu::RegistrationState& state = device.state;
  RegistrationResult result;
  result.source_points = source_points;
  result.iterations = static_cast<int>(device.progress.iterations);
  if (source_points == 0) {
    return result;
  }
  result.T_target_source = from_device(state.pose);
  result.used_prior = state.constrained != gpu::kUnconstrained;
  const Matrix6d h = symmetric(state.system);
  const Matrix6d geometric =
      fictitious > 0.0
          ? Matrix6d(h - fictitious * identity_information(state.system + gpu::kGeometryAt))
          : h;
  const bool assessed =
      Eigen::Vector3f(state.directions[0].x, state.directions[0].y, state.directions[0].z).norm() >
      0.5F;
  if (assessed) {
    read_directions(state, geometric, result);
  } else {
    result.information = geometric;
  }
  // The device perturbs in the target's axes about the source's origin: delta_target = diag(R, R)
  // delta_body.
  const Matrix6d to_target = axes(result.T_target_source.linear());
  result.hessian = turned(h, to_target);
  result.information = turned(result.information, to_target);
  const Eigen::Map<const Eigen::Matrix<float, 6, 1>> gradient(state.system + 21);
  result.gradient = to_target.transpose() * gradient.cast<double>();
  if (state.constrained == gpu::kWithPrior) {
    result.pull = to_target.transpose() * geometric_gradient(state, fictitious);
  }
  result.cost = static_cast<double>(state.system[gpu::kCostAt]);
  result.inliers = static_cast<int>(state.system[gpu::kInliersAt]);
  const double matches = static_cast<double>(state.system[gpu::kMatchesAt]);
  result.matches = static_cast<int>(matches);
  const double squared = static_cast<double>(state.system[gpu::kSquaredAt]);
  result.residual_rms = matches > 0.0 ? std::sqrt(std::max(squared, 0.0) / matches) : 0.0;
  result.overlap = static_cast<double>(result.inliers) / source_points;

  const bool finite = result.T_target_source.matrix().allFinite() && result.hessian.allFinite();
  if (result.inliers < config.min_inliers) {
    result.status = RegistrationStatus::too_few_points;
  } else if (device.progress.failed != 0 || !finite) {
    result.status = RegistrationStatus::diverged;
  } else if (result.overlap < config.min_overlap) {
    result.status = RegistrationStatus::too_little_overlap;
  } else if (device.progress.converged == 0) {
    result.status = RegistrationStatus::not_converged;
  } else if (assessed && has_none(result)) {
    result.status = RegistrationStatus::degenerate;
  } else {
    result.status = RegistrationStatus::converged;
  }
  return result;
}

double surface_of_match(const RegistrationResult& result) {
  const double translation = result.information.topLeftCorner<3, 3>().trace();
  const double rotation = result.information.bottomRightCorner<3, 3>().trace();
  return translation > 0.0 ? rotation / translation / std::max(result.inliers, 1) : 0.0;
}

double inflation(const RegistrationResult& result, const CovarianceModel& model) {
  const double worse = std::max(0.0, result.residual_rms / model.rms_expected - 1.0);
  const double overlap = std::max(result.overlap, 0.3);
  const double each = static_cast<double>(result.matches) / std::max(result.inliers, 1);
  const double sparse =
      model.area > 0.0 ? std::min(surface_of_match(result) / model.area, model.most_sparse) : 1.0;
  return model.kappa * each * (1.0 + worse) / (overlap * overlap) * sparse * sparse;
}

Matrix6d covariance(const RegistrationResult& result, const CovarianceModel& model) {
  // In units in which all directions without information are equally unknown.
  Vector6d unit;
  unit << Eigen::Vector3d::Constant(model.sigma_unknown_translation),
      Eigen::Vector3d::Constant(model.sigma_unknown_rotation);
  const Matrix6d scaled =
      unit.asDiagonal() * (result.information / inflation(result, model)) * unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scaled);
  const Vector6d variances = eigen.eigenvalues().cwiseMax(0.0).array().max(1.0).inverse();
  Matrix6d covariance = unit.asDiagonal() * eigen.eigenvectors() * variances.asDiagonal() *
                        eigen.eigenvectors().transpose() * unit.asDiagonal();
  covariance.diagonal().head<3>().array() += model.sigma_translation * model.sigma_translation;
  covariance.diagonal().tail<3>().array() += model.sigma_rotation * model.sigma_rotation;
  return covariance;
}

}  // namespace adit
