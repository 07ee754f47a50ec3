// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/evaluate_alignment.hpp"

#include <cassert>

#include <Eigen/SVD>

namespace adit {
namespace {

Eigen::Vector3d mean_of(std::span<const Eigen::Vector3d> points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    sum += p;
  }
  return sum / static_cast<double>(points.size());
}

std::vector<Eigen::Vector3d> positions_of(std::span<const Eigen::Isometry3d> poses) {
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(poses.size());
  for (const Eigen::Isometry3d& pose : poses) {
    positions.emplace_back(pose.translation());
  }
  return positions;
}

}  // namespace

std::string_view to_string(Alignment alignment) {
  switch (alignment) {
    case Alignment::none:
      return "none";
    case Alignment::origin:
      return "origin";
    case Alignment::se3:
      return "se3";
    case Alignment::sim3:
      return "sim3";
  }
  return "";
}

Eigen::Isometry3d Similarity::operator*(const Eigen::Isometry3d& pose) const {
  Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
  moved.linear() = rotation * pose.linear();
  moved.translation() = scale * (rotation * pose.translation()) + translation;
  return moved;
}

std::optional<Similarity> umeyama(std::span<const Eigen::Vector3d> from,
                                  std::span<const Eigen::Vector3d> to, bool with_scale) {
  assert(from.size() == to.size());
  if (from.size() < 3) {
    return std::nullopt;
  }
  const Eigen::Vector3d from_mean = mean_of(from);
  const Eigen::Vector3d to_mean = mean_of(to);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double variance = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    covariance += (to[i] - to_mean) * (from[i] - from_mean).transpose();
    variance += (from[i] - from_mean).squaredNorm();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d singular = svd.singularValues();
  // Two directions must be seen for the rotation to be determined; 1e-12 of the first is rounding.
  if (!(singular(1) > 1e-12 * singular(0)) || !(singular(0) > 0.0)) {
    return std::nullopt;
  }
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) {
    sign.z() = -1.0;  // the best rotation, not the best reflection
  }
  Similarity result;
  result.rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  result.scale = with_scale ? singular.dot(sign) / variance : 1.0;
  result.translation = to_mean - result.scale * (result.rotation * from_mean);
  return result;
}

std::optional<Similarity> align(std::span<const Eigen::Isometry3d> estimate,
                                std::span<const Eigen::Isometry3d> truth, Alignment alignment) {
  assert(estimate.size() == truth.size() && !estimate.empty());
  switch (alignment) {
    case Alignment::none:
      return Similarity{};
    case Alignment::origin: {
      const Eigen::Isometry3d motion = truth.front() * estimate.front().inverse();
      return Similarity{motion.linear(), motion.translation(), 1.0};
    }
    case Alignment::se3:
    case Alignment::sim3:
      return umeyama(positions_of(estimate), positions_of(truth), alignment == Alignment::sim3);
  }
  return std::nullopt;
}

}  // namespace adit
