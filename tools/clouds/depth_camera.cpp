// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/depth_camera.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace adit {
DepthCamera::DepthCamera(const CameraModel& model) : model_(model) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  const CameraProjection projection(model);
  rays_.reserve(model.width * model.height);
  for (std::size_t v = 0; v < model.height; ++v) {
    for (std::size_t u = 0; u < model.width; ++u) {
      const auto ray = projection.ray({static_cast<double>(u), static_cast<double>(v)});
      rays_.push_back(ray && ray->z() > 0.0 ? std::array{static_cast<float>(ray->x() / ray->z()),
                                                         static_cast<float>(ray->y() / ray->z())}
                                            : std::array{kNone, kNone});
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
