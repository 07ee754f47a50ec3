// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/gnss/gnss_noise.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace adit {
namespace {

/// Standard deviation of the horizontal error, m.
double best_sigma(GnssFixKind kind) {
  switch (kind) {
    case GnssFixKind::ground_augmented:
      return 0.02;
    case GnssFixKind::satellite_augmented:
      return 0.3;
    default:
      return 1.5;
  }
}

constexpr double kUpwards = 2.0;   // the vertical error over the horizontal one
constexpr double kUnstated = 3.0;  // the usual error over the best one

bool is_stated(const std::optional<Eigen::Matrix3d>& covariance) {
  return covariance && covariance->allFinite() && covariance->diagonal().minCoeff() > 0.0;
}

/// As if the fix had a height.
Eigen::Matrix3d covariance_in_space(const GnssFix& fix, const GnssConfig& config) {
  const double best = best_sigma(fix.kind);
  const Eigen::Vector3d least = Eigen::Vector3d(best, best, kUpwards * best).cwiseAbs2();
  std::optional<Eigen::Matrix3d> stated = fix.covariance;
  if (stated && !has_height(*stated)) {
    (*stated)(2, 2) = stated->topLeftCorner<2, 2>().diagonal().maxCoeff();
  }
  if (!is_stated(stated)) {
    return (kUnstated * kUnstated * config.noise_scale * config.noise_scale * least).asDiagonal();
  }
  // By its own axes where it is that of an ellipsoid, so that what raises one leaves the others.
  Eigen::Matrix3d covariance = config.noise_scale * config.noise_scale * *stated;
  covariance = (0.5 * (covariance + covariance.transpose())).eval();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> scaled(
      least.cwiseSqrt().cwiseInverse().asDiagonal() * covariance *
      least.cwiseSqrt().cwiseInverse().asDiagonal());
  const Eigen::Matrix3d raised = scaled.eigenvectors() *
                                 scaled.eigenvalues().cwiseMax(1.0).asDiagonal() *
                                 scaled.eigenvectors().transpose();
  covariance = least.cwiseSqrt().asDiagonal() * raised * least.cwiseSqrt().asDiagonal();
  return 0.5 * (covariance + covariance.transpose());
}

}  // namespace

Eigen::Matrix3d without_height(Eigen::Matrix3d covariance) {
  covariance.row(2).setZero();
  covariance.col(2).setZero();
  covariance(2, 2) = kUnknownHeight * kUnknownHeight;
  return covariance;
}

Eigen::Matrix3d fix_covariance(const GnssFix& fix, const GnssConfig& config) {
  const Eigen::Matrix3d covariance = covariance_in_space(fix, config);
  return fix.covariance && !has_height(*fix.covariance) ? without_height(covariance) : covariance;
}

Eigen::Matrix3d fix_information(const Eigen::Matrix3d& covariance, bool height) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  if (height) {
    information = covariance.inverse();
  } else {
    information.topLeftCorner<2, 2>() = covariance.topLeftCorner<2, 2>().inverse();
  }
  return 0.5 * (information + information.transpose());
}

std::vector<double> independent_shares(std::span<const double> times, double correlation) {
  std::vector<double> shares(times.size());
  std::size_t begin = 0;
  for (std::size_t end = 1; end <= times.size(); ++end) {
    // A step back is another session.
    if (end < times.size() && times[end] >= times[end - 1] &&
        times[end] - times[end - 1] < 2.0 * correlation) {
      continue;
    }
    const double whole = times[end - 1] - times[begin];
    const double independent = 1.0 + whole / (2.0 * correlation);
    for (std::size_t i = begin; i < end; ++i) {
      const double from = times[std::max(begin, i == 0 ? 0 : i - 1)];
      const double to = times[std::min(end - 1, i + 1)];
      shares[i] = whole > 0.0 ? independent * 0.5 * (to - from) / whole
                              : independent / static_cast<double>(end - begin);
    }
    begin = end;
  }
  return shares;
}

}  // namespace adit
