// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/depth_camera.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace adit {
namespace {

using Ray = Eigen::Vector2d;  // x/z, y/z

/// Where the lens shows what lies along the ray.
Ray distorted(const Ray& ray, const std::array<double, 8>& d) {
  const double r2 = ray.squaredNorm();
  const double radial =
      (1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]))) / (1.0 + r2 * (d[5] + r2 * (d[6] + r2 * d[7])));
  const double xy = ray.x() * ray.y();
  return {ray.x() * radial + 2.0 * d[2] * xy + d[3] * (r2 + 2.0 * ray.x() * ray.x()),
          ray.y() * radial + d[2] * (r2 + 2.0 * ray.y() * ray.y()) + 2.0 * d[3] * xy};
}

/// The ray that the lens shows there, by fixed-point iteration; NaN where there is none.
Ray undistorted(const Ray& seen, const std::array<double, 8>& d) {
  constexpr int kMostSteps = 50;
  constexpr double kSmall = 1e-9;
  Ray ray = seen;
  double last = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMostSteps; ++step) {
    const Ray error = seen - distorted(ray, d);
    const double size = error.norm();
    if (size < kSmall) {
      return ray;
    }
    if (!(size < last)) {
      break;  // beyond what the lens shows
    }
    last = size;
    ray += error;
  }
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return {kNone, kNone};
}

}  // namespace

DepthCamera::DepthCamera(const CameraModel& model) : model_(model) {
  const bool distorts =
      std::ranges::any_of(model.distortion, [](double number) { return number != 0.0; });
  rays_.reserve(model.width * model.height);
  for (std::size_t v = 0; v < model.height; ++v) {
    for (std::size_t u = 0; u < model.width; ++u) {
      const Ray seen((static_cast<double>(u) - model.cx) / model.fx,
                     (static_cast<double>(v) - model.cy) / model.fy);
      const Ray ray = distorts ? undistorted(seen, model.distortion) : seen;
      rays_.push_back({static_cast<float>(ray.x()), static_cast<float>(ray.y())});
    }
  }
}

std::vector<Point> DepthCamera::points(std::span<const float> depths) const {
  std::vector<Point> points(rays_.size());
  for (std::size_t i = 0; i < std::min(depths.size(), rays_.size()); ++i) {
    const float z = depths[i];
    if (z > 0.0F && std::isfinite(z) && std::isfinite(rays_[i][0])) {
      points[i] = {rays_[i][0] * z, rays_[i][1] * z, z, 0.0F};
    }
  }
  return points;
}

}  // namespace adit
