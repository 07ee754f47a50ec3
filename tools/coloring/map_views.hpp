// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "adit/tools/cameras/camera_source.hpp"
#include "adit/tools/map_products/dense_cloud.hpp"

namespace adit {

/// An image that a map is coloured by.
struct MapView {
  std::size_t camera = 0;  ///< index
  std::size_t image = 0;   ///< index, of the camera's
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
};

/// The images of all cameras, whose mounting is known, that the path has a pose for, in the order
/// of cameras and times. Of a camera that stands still or moves slowly the first: the next is taken
/// half a metre or 15 degrees farther on.
std::vector<MapView> choose_views(std::span<const CameraSource> cameras, const SensorPath& path);

}  // namespace adit
