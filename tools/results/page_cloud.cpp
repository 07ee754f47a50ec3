// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/results/page_cloud.hpp"

namespace adit {

void PageCloud::add(std::span<const Point> points, const Eigen::Isometry3d& T_map_lidar,
                    uint32_t pose) {
  for (const Point& point : points) {
    const Eigen::Vector3f p(point.x, point.y, point.z);
    const Eigen::Vector3d place = T_map_lidar * p.cast<double>();
    if (!thinning_.take(place)) {
      continue;
    }
    points_.push_back({.p = p, .intensity = point.intensity, .pose = pose});
    places_.push_back(place.cast<float>());
    if (points_.size() > most_) {
      widen();
    }
  }
}

void PageCloud::widen() {
  voxel_ *= kWider;
  thinning_ = MapThinning(voxel_, points_.size());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (thinning_.take(places_[i].cast<double>())) {
      points_[kept] = points_[i];
      places_[kept] = places_[i];
      ++kept;
    }
  }
  points_.resize(kept);
  places_.resize(kept);
}

}  // namespace adit
