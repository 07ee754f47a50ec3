// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Twins of voxel_map_finish.comp, and of registration_linearize.comp for every method, number of
// neighbours and robust kernel. Tangent vectors as in benchmarks/reference/vgicp.hpp.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <Eigen/Eigenvalues>

#include "adit/benchmarks/reference/vgicp.hpp"
#include "adit/engine/kernels/registration.hpp"
#include "adit/engine/kernels/voxel_map.hpp"

namespace adit::reference {

/// A voxel as alignments read it.
struct FinishedVoxel {
  uint32_t count = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();   ///< m
  Eigen::Matrix3d form = Eigen::Matrix3d::Zero();   ///< VGICP: mean constraint; NDT: covariance,
                                                    ///< m^2; point to plane: n n^T
  Eigen::Vector2d faces = Eigen::Vector2d::Zero();  ///< as Voxel::faces(); NDT: zero
};
using FinishedMap = std::map<Cell, FinishedVoxel>;

/// The Gaussian of a voxel's points: sample covariance, its eigenvalues raised to the largest's
/// part and to the floor.
inline FinishedVoxel gaussian_of(std::span<const Eigen::Vector3d> points,
                                 const engine::FinishSettings& settings) {
  FinishedVoxel voxel{.count = static_cast<uint32_t>(points.size())};
  for (const Eigen::Vector3d& p : points) {
    voxel.mean += p / static_cast<double>(points.size());
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    covariance += (p - voxel.mean) * (p - voxel.mean).transpose();
  }
  covariance /= static_cast<double>(std::max<size_t>(points.size(), 2) - 1);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
  const double floor = std::max(settings.least_ratio * eigen.eigenvalues()[2],
                                settings.least_sigma * settings.least_sigma);
  voxel.form = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(floor).asDiagonal() *
               eigen.eigenvectors().transpose();
  return voxel;
}

/// A finished table, keys unpacked; voxels that were left out are not there.
inline FinishedMap decode_finished(std::span<const gpu::GaussianCell> table) {
  FinishedMap map;
  const auto real = [](uint32_t bits) { return static_cast<double>(std::bit_cast<float>(bits)); };
  const auto half = [](uint32_t bits) {
    return static_cast<double>(std::bit_cast<Eigen::half>(static_cast<uint16_t>(bits)));
  };
  for (const gpu::GaussianCell& cell : table) {
    if (cell.key == gpu::kFree || cell.count == 0) {
      continue;
    }
    const Cell at = unpacked_cell(cell.key);
    FinishedVoxel voxel{.count = cell.count};
    voxel.mean << real(cell.sum_x), real(cell.sum_y), real(cell.sum_z);
    voxel.form << real(cell.xx), real(cell.xy), real(cell.xz),  //
        real(cell.xy), real(cell.yy), real(cell.yz),            //
        real(cell.xz), real(cell.yz), real(cell.zz);
    voxel.faces << half(cell.surfaces), half(cell.surfaces >> 16U);
    map[at] = voxel;
  }
  return map;
}

/// A VGICP map in the same form.
inline FinishedMap finished(const VoxelMap& map) {
  FinishedMap result;
  for (const auto& [at, voxel] : map.voxels) {
    result[at] = {.count = static_cast<uint32_t>(voxel.count),
                  .mean = voxel.mean(at, map.voxel_size),
                  .form = voxel.constraint(),
                  .faces = voxel.faces()};
  }
  return result;
}

/// A point of the source, or a Gaussian of it.
struct SourceItem {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Matrix3d form = Eigen::Matrix3d::Zero();    ///< constraint; covariance for kNdtToNdt
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< towards the sensor; zero: no plane
  Eigen::Vector3d facing = Eigen::Vector3d::Zero();  ///< as facing_normal()
};

struct Objective {
  engine::RegistrationOptions options{};
  double robust_width = 1.0;
  double score_weight = 1.0;    ///< -d1 d2 of NDT's score
  double score_exponent = 0.0;  ///< d2 / 2
  double d_max = 0.0;           ///< m
  Eigen::Vector3d viewpoint = Eigen::Vector3d::Zero();
  /// The Hessian that steps are taken with: of NDT the score's own, no less than a tenth of the
  /// quadratic's along each match's error.
  bool stepping = false;
};

/// Everything a linearisation adds up.
struct FullSystem {
  System system{};
  int64_t matches = 0;
  double weighted_cost = 0.0;  ///< sum of w e^T Omega e: the natural scale of the gradient
  Matrix6d isotropic = Matrix6d::Zero();           ///< sum of w J^T J
  Vector6d isotropic_gradient = Vector6d::Zero();  ///< sum of w J^T e
};

inline std::vector<Cell> neighbours_of(const Cell& cell, uint32_t count) {
  std::vector<Cell> cells;
  for (int64_t x = -1; x <= 1; ++x) {
    for (int64_t y = -1; y <= 1; ++y) {
      for (int64_t z = -1; z <= 1; ++z) {
        const int64_t away = std::abs(x) + std::abs(y) + std::abs(z);
        if (away == 0 || (count == 7 && away == 1) || count == 27) {
          cells.push_back({cell[0] + x, cell[1] + y, cell[2] + z});
        }
      }
    }
  }
  return cells;
}

/// Weight and cost of a match of squared Mahalanobis distance s.
struct Weighed {
  double weight = 1.0;
  double cost = 0.0;
};

inline Weighed weigh(const Objective& objective, double s) {
  const double width2 = objective.robust_width * objective.robust_width;
  const double u = s / width2;
  Weighed result{1.0, s};
  switch (objective.options.robust) {
    case gpu::kHuber:
      result = u <= 1.0 ? result : Weighed{1.0 / std::sqrt(u), width2 * (2.0 * std::sqrt(u) - 1.0)};
      break;
    case gpu::kCauchy:
      result = {1.0 / (1.0 + u), width2 * std::log1p(u)};
      break;
    case gpu::kGemanMcClure:
      result = {1.0 / ((1.0 + u) * (1.0 + u)), s / (1.0 + u)};
      break;
    default:
      break;
  }
  if (objective.options.method == gpu::kNdt || objective.options.method == gpu::kNdtToNdt) {
    const double likelihood = std::exp(-objective.score_exponent * s);
    return {result.weight * objective.score_weight * likelihood,
            -0.5 * objective.score_weight / objective.score_exponent * likelihood};
  }
  return result;
}

inline Eigen::Matrix3d information_of(uint32_t method, const Eigen::Matrix3d& target,
                                      const Eigen::Matrix3d& source) {
  switch (method) {
    case gpu::kPointToPlane:
      return target;
    case gpu::kNdt:
      return target.inverse();
    case gpu::kNdtToNdt:
      return (target + source).inverse();
    default:
      return (2.0 * Eigen::Matrix3d::Identity() - (1.0 - kPlaneEpsilon) * (target + source))
          .inverse();
  }
}

/// The point faces away from the target's sensor.
inline bool back_face(const Objective& objective, const SourceItem& item,
                      const Eigen::Isometry3d& pose) {
  const Eigen::Vector3d ray = pose * item.p - objective.viewpoint;
  return objective.options.drop_back_faces &&
         ray.dot(pose.linear() * item.normal) > 0.174 * ray.norm();
}

inline FullSystem linearize(std::span<const SourceItem> source, const FinishedMap& target,
                            double voxel_size, const Eigen::Isometry3d& pose,
                            const Objective& objective) {
  FullSystem sums;
  for (const SourceItem& item : source) {
    if (back_face(objective, item, pose)) {
      continue;
    }
    const Eigen::Vector3d q = pose * item.p;
    bool matched = false;
    for (const Cell& cell :
         neighbours_of(place_of(q, voxel_size).cell, objective.options.neighbours)) {
      const auto found = target.find(cell);
      if (found == target.end() || (found->second.mean - q).norm() > objective.d_max ||
          is_other_face(pose.linear() * item.facing, found->second.faces, found->second.form)) {
        continue;
      }
      matched = true;
      const Eigen::Vector3d e = found->second.mean - q;
      const Eigen::Matrix3d turned = pose.linear() * item.form * pose.linear().transpose();
      const Eigen::Matrix3d omega =
          information_of(objective.options.method, found->second.form, turned);
      const double s = e.dot(omega * e);
      const Weighed w = weigh(objective, s);
      Eigen::Matrix<double, 3, 6> j;
      j << -Eigen::Matrix3d::Identity(), skew(pose.linear() * item.p);
      const bool score =
          objective.options.method == gpu::kNdt || objective.options.method == gpu::kNdtToNdt;
      const double less =
          objective.stepping && score ? std::min(2.0 * objective.score_exponent, 0.9 / s) : 0.0;
      const Eigen::Matrix3d curvature = omega - less * (omega * e) * (omega * e).transpose();
      sums.system.hessian += w.weight * j.transpose() * curvature * j;
      sums.system.gradient += w.weight * j.transpose() * omega * e;
      sums.system.cost += w.cost;
      sums.system.squared_distance += objective.options.method == gpu::kVgicp
                                          ? e.dot(found->second.form * e)
                                          : s / omega.trace();
      sums.weighted_cost += w.weight * s;
      sums.isotropic += w.weight * j.transpose() * j;
      sums.isotropic_gradient += w.weight * j.transpose() * e;
      sums.matches += 1;
    }
    sums.system.inliers += matched ? 1 : 0;
  }
  return sums;
}

}  // namespace adit::reference
