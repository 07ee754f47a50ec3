// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/simulator/camera_options.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "adit/tools/simulator/simulation.hpp"
#include "adit/tools/simulator/simulation_limits.hpp"
#include "adit/tools/support/nearest_name.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

using Eigen::Vector3d;

/// Where each camera looks, in the IMU's axes.
const std::array<std::pair<std::string_view, Vector3d>, 4>& sides() {
  static const std::array<std::pair<std::string_view, Vector3d>, 4> kSides{
      {{"front", Vector3d(1.0, 0.0, 0.0)},
       {"left", Vector3d(0.0, 1.0, 0.0)},
       {"right", Vector3d(0.0, -1.0, 0.0)},
       {"back", Vector3d(-1.0, 0.0, 0.0)}}};
  return kSides;
}

Vector3d direction_of(std::string_view name) {
  for (const auto& [known, direction] : sides()) {
    if (known == name) {
      return direction;
    }
  }
  throw UsageError("there is no camera '" + std::string(name) + "'. " +
                   suggestion(std::string(name), camera_names()) + ".");
}

}  // namespace

std::vector<std::string> camera_names() {
  std::vector<std::string> names;
  for (const auto& [name, direction] : sides()) {
    names.emplace_back(name);
  }
  return names;
}

std::vector<std::string> camera_lens_names() {
  return {"perspective", "fisheye"};
}

CameraModel camera_lens(std::string_view lens) {
  if (lens == "perspective") {
    return {.width = 640,
            .height = 480,
            .fx = 400.0,
            .fy = 400.0,
            .cx = 321.4,
            .cy = 238.2,
            .distortion = {-0.08, 0.02, 4e-4, -3e-4, 0.0}};
  }
  if (lens == "fisheye") {
    return {.width = 640,
            .height = 640,
            .fx = 207.2,
            .fy = 207.2,
            .cx = 318.3,
            .cy = 320.9,
            .distortion = {-0.01, 0.002, -3e-4, 0.0},
            .lens = Lens::fisheye};
  }
  throw UsageError("there is no lens '" + std::string(lens) + "'. " +
                   suggestion(std::string(lens), camera_lens_names()) + ".");
}

Eigen::Isometry3d optical_frame(const Eigen::Isometry3d& T_imu_mount) {
  Eigen::Isometry3d T_mount_optical = Eigen::Isometry3d::Identity();
  T_mount_optical.linear() << 0.0, 0.0, 1.0,  //
      -1.0, 0.0, 0.0,                         //
      0.0, -1.0, 0.0;
  return T_imu_mount * T_mount_optical;
}

void require_camera(std::string_view name) {
  direction_of(name);
}

Eigen::Isometry3d camera_mount_of(std::string_view name) {
  constexpr double kAhead = 0.1;   // m
  constexpr double kBelow = 0.12;  // m
  const Vector3d ahead = direction_of(name);
  Eigen::Isometry3d T_imu_mount = Eigen::Isometry3d::Identity();
  T_imu_mount.linear().col(0) = ahead;
  T_imu_mount.linear().col(1) = Vector3d::UnitZ().cross(ahead);
  T_imu_mount.translation() =
      lidar_mount().translation() + kAhead * ahead - kBelow * Vector3d::UnitZ();
  return T_imu_mount;
}

CameraOptions camera_named(std::string_view text) {
  const std::size_t colon = text.find(':');
  CameraOptions camera;
  camera.name = text.substr(0, colon);
  if (colon != std::string_view::npos) {
    camera.lens = text.substr(colon + 1);
  }
  camera.T_imu_camera = optical_frame(camera_mount_of(camera.name));
  camera_lens(camera.lens);
  return camera;
}

void require_cameras(std::span<const CameraOptions> cameras) {
  for (const CameraOptions& camera : cameras) {
    require_camera(camera.name);
    camera_lens(camera.lens);
    require_camera_rate(camera.rate);
    if (std::ranges::count(cameras, camera.name, &CameraOptions::name) > 1) {
      throw UsageError("there are two cameras '" + camera.name + "'; each has a name of its own.");
    }
  }
}

}  // namespace adit
