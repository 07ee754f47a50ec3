// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/submaps/ground_plane.hpp"

#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>

namespace adit {
namespace {

constexpr double kLeastCosine = 0.906;    // 25 degrees against the lidar's z
constexpr double kAgreeing = 0.966;       // 15 degrees between normals
constexpr double kLeastOffset = 0.2;      // m, of the plane to the sensor
constexpr double kThickness = 0.15;       // m, of the plane, to either side
constexpr double kReach = 30.0;           // m; farther ground may lie at another slope
constexpr std::size_t kCandidates = 100;  // planes that are tried
constexpr std::size_t kLeastPoints = 100;
constexpr double kLeastShare = 0.05;  // share of the points within reach
constexpr double kLeastWidth = 1.0;   // m, root mean square along the narrower direction
constexpr int kRefinements = 3;

struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset = 0.0;  ///< m, of the sensor above it
};

bool lies_below(const Plane& plane) {
  return plane.normal.z() > kLeastCosine && plane.offset > kLeastOffset;
}

bool supports(const PlanePoint& point, const Plane& plane) {
  return std::abs(plane.normal.dot(point.p) + plane.offset) < kThickness &&
         plane.normal.dot(point.normal) > kAgreeing;
}

std::size_t support(std::span<const PlanePoint> points, const Plane& plane) {
  std::size_t count = 0;
  for (const PlanePoint& point : points) {
    count += supports(point, plane) ? 1U : 0U;
  }
  return count;
}

/// The plane through the points that support this one, and how far they spread along its narrower
/// direction (m).
struct Fit {
  Plane plane;
  std::size_t points = 0;
  double width = 0.0;
};

Fit refined(std::span<const PlanePoint> points, const Plane& plane) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  Fit fit;
  for (const PlanePoint& point : points) {
    if (supports(point, plane)) {
      sum += point.p;
      products += point.p * point.p.transpose();
      ++fit.points;
    }
  }
  if (fit.points < 3) {
    return fit;
  }
  const auto n = static_cast<double>(fit.points);
  const Eigen::Vector3d mean = sum / n;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(products / n -
                                                             mean * mean.transpose());
  const Eigen::Vector3d normal = eigen.eigenvectors().col(0);
  fit.plane.normal = normal.z() < 0.0 ? Eigen::Vector3d(-normal) : normal;
  fit.plane.offset = -fit.plane.normal.dot(mean);
  fit.width = std::sqrt(std::max(eigen.eigenvalues()(1), 0.0));
  return fit;
}

}  // namespace

std::optional<Eigen::Vector3d> ground_normal(std::span<const PlanePoint> points) {
  std::vector<PlanePoint> near;
  for (const PlanePoint& point : points) {
    if (point.p.norm() < kReach) {
      near.push_back(point);
    }
  }
  Plane best;
  std::size_t most = 0;
  const std::size_t stride = std::max<std::size_t>(near.size() / kCandidates, 1);
  for (std::size_t i = 0; i < near.size(); i += stride) {
    const Plane plane{.normal = near[i].normal, .offset = -near[i].normal.dot(near[i].p)};
    const std::size_t count = lies_below(plane) ? support(near, plane) : 0;
    if (count > most) {
      most = count;
      best = plane;
    }
  }
  Fit fit{.plane = best, .points = most};
  for (int k = 0; k < kRefinements && fit.points >= kLeastPoints; ++k) {
    fit = refined(near, fit.plane);
  }
  const bool enough =
      fit.points >= kLeastPoints &&
      static_cast<double>(fit.points) >= kLeastShare * static_cast<double>(near.size());
  return enough && fit.width >= kLeastWidth && lies_below(fit.plane)
             ? std::optional(fit.plane.normal)
             : std::nullopt;
}

}  // namespace adit
