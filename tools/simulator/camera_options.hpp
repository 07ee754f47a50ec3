// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The cameras that a simulation can have: where they look, and their lenses.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "adit/slam/core/camera_model.hpp"

namespace adit {

/// A camera. Its images are on /camera_NAME/image_raw, its optical frame (x right, y down, z
/// forward) is camera_NAME.
struct CameraOptions {
  std::string name = "front";
  std::string lens = "perspective";
  /// Hz. On foot (1.2 m/s) two images a second are 0.6 m apart, so several show each surface, and a
  /// minute of them takes 111 MB.
  int rate = 2;
  Eigen::Isometry3d T_imu_camera = Eigen::Isometry3d::Identity();  ///< from its optical frame

  std::string frame() const { return "camera_" + name; }
  std::string topic(std::string_view what) const { return "/" + frame() + "/" + std::string(what); }
};

/// front, left, right, back.
std::vector<std::string> camera_names();

/// perspective, fisheye.
std::vector<std::string> camera_lens_names();

/// A camera from NAME or NAME:LENS, at camera_mount_of(). Throws UsageError for unknown names, with
/// the nearest.
CameraOptions camera_named(std::string_view text);

/// Throws UsageError for an unknown name, with the nearest.
void require_camera(std::string_view name);

/// Where a camera of that name is mounted unless something else is asked for, with x ahead, y left
/// and z up: 0.1 m off the lidar in the direction that it looks in, and 0.12 m below it. Throws
/// UsageError as require_camera().
Eigen::Isometry3d camera_mount_of(std::string_view name);

/// The calibration of a lens. perspective: 640 x 480 pixels, 80 degrees across. fisheye: 640 x 640
/// pixels, 180 degrees across and more in the corners. Throws UsageError for other names, with the
/// nearest.
CameraModel camera_lens(std::string_view lens);

/// The optical frame of a camera that is mounted with x ahead, y left and z up.
Eigen::Isometry3d optical_frame(const Eigen::Isometry3d& T_imu_mount);

/// Throws UsageError where a name, a lens or a rate makes no sense, or two have the same name.
void require_cameras(std::span<const CameraOptions> cameras);

}  // namespace adit
