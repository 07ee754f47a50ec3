// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/dense_cloud.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "adit/tools/clouds/returns.hpp"

namespace adit {
namespace {

constexpr Nanoseconds kLongestStep = std::chrono::milliseconds(500);

}  // namespace

SensorPath::SensorPath(std::vector<StampedPose> poses) : poses_(std::move(poses)) {
  std::ranges::stable_sort(poses_, {}, &StampedPose::stamp);
}

Eigen::Isometry3d SensorPath::Stretch::at(double after) const {
  return T_map_lidar_ * se3_exp(after * velocity_);
}

std::optional<SensorPath::Stretch> SensorPath::from(Nanoseconds stamp) const {
  const auto here = std::ranges::lower_bound(poses_, stamp, {}, &StampedPose::stamp);
  if (here == poses_.end() || here->stamp != stamp) {
    return std::nullopt;
  }
  const auto is_step = [](const StampedPose& a, const StampedPose& b) {
    return a.stamp < b.stamp && b.stamp - a.stamp <= kLongestStep;
  };
  const auto velocity = [](const StampedPose& a, const StampedPose& b) -> Vector6d {
    return se3_log(a.pose.inverse() * b.pose) / seconds(b.stamp - a.stamp);
  };
  Stretch stretch;
  stretch.T_map_lidar_ = here->pose;
  stretch.velocity_.setZero();
  if (const auto next = std::next(here); next != poses_.end() && is_step(*here, *next)) {
    stretch.velocity_ = velocity(*here, *next);
  } else if (here != poses_.begin() && is_step(*std::prev(here), *here)) {
    stretch.velocity_ = velocity(*std::prev(here), *here);
  }
  return stretch;
}

std::optional<Eigen::Isometry3d> SensorPath::at(Nanoseconds time) const {
  const auto after = std::ranges::upper_bound(poses_, time, {}, &StampedPose::stamp);
  if (after == poses_.begin() || time - std::prev(after)->stamp > kLongestStep) {
    return std::nullopt;
  }
  const Nanoseconds before = std::prev(after)->stamp;
  return from(before)->at(seconds(time - before));
}

std::vector<CloudPoint> placed_points(const Sweep& sweep, const SensorPath::Stretch& path) {
  std::vector<CloudPoint> placed;
  placed.reserve(sweep.points.size());
  float last_time = -1.0F;
  Eigen::Isometry3d T_map_lidar = path.at(0.0);
  for (std::size_t i = 0; i < sweep.points.size(); ++i) {
    const Point& point = sweep.points[i];
    if (!is_return(point)) {
      continue;
    }
    const float time = sweep.times.empty() ? 0.0F : sweep.times[i];
    if (!sweep.times.empty() && time != last_time) {  // those of one firing share a pose
      T_map_lidar = path.at(static_cast<double>(time));
      last_time = time;
    }
    const Eigen::Vector3d p_map = T_map_lidar * Eigen::Vector3d(point.x, point.y, point.z);
    placed.push_back(
        {.position = p_map,
         .in_map = p_map,
         .time = sweep.stamp + nanoseconds(std::isfinite(time) ? static_cast<double>(time) : 0.0),
         .intensity = point.intensity,
         .ring = sweep.rings.empty() ? uint16_t{0} : sweep.rings[i]});
  }
  return placed;
}

}  // namespace adit
