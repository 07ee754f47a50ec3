// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/coloring/map_views.hpp"

#include <optional>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/units.hpp"

namespace adit {
namespace {

// Nearer views show little that is new: at 5 m by half a metre, 6 degrees aside.
constexpr double kDistance = 0.5;         // m
constexpr double kTurn = 15.0 * kDegree;  // a quarter of a narrow lens's field of view

bool has_moved_on(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
  const Eigen::Isometry3d step = from.inverse() * to;
  return step.translation().norm() >= kDistance ||
         Eigen::AngleAxisd(step.linear()).angle() >= kTurn;
}

}  // namespace

std::vector<MapView> choose_views(std::span<const CameraSource> cameras, const SensorPath& path) {
  std::vector<MapView> views;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const CameraSource& camera = cameras[i];
    std::optional<Eigen::Isometry3d> last;
    const std::span<const Nanoseconds> stamps = camera.images->stamps();
    for (std::size_t k = 0; k < stamps.size(); ++k) {
      const auto T_map_lidar = path.at(stamps[k] + nanoseconds(camera.time_offset));
      if (!T_map_lidar) {
        continue;
      }
      const Eigen::Isometry3d T_map_camera = *T_map_lidar * *camera.T_lidar_camera;
      if (!last || has_moved_on(*last, T_map_camera)) {
        views.push_back({.camera = i, .image = k, .T_map_camera = T_map_camera});
        last = T_map_camera;
      }
    }
  }
  return views;
}

}  // namespace adit
