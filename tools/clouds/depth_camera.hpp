// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Depth images as sweeps: each pixel's depth along the ray that the camera sees it by.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "adit/slam/core/types.hpp"

namespace adit {

/// A camera's calibration, as OpenCV and ROS define it.
struct CameraModel {
  std::size_t width = 0;   ///< pixels
  std::size_t height = 0;  ///< pixels
  double fx = 0.0;         ///< pixels
  double fy = 0.0;         ///< pixels
  double cx = 0.0;         ///< pixels
  double cy = 0.0;         ///< pixels
  /// k1 k2 p1 p2 k3 (plumb_bob) and k4 k5 k6 (rational_polynomial); zeros: no distortion.
  std::array<double, 8> distortion{};
};

/// The rays of a camera's pixels, worked out once.
class DepthCamera {
 public:
  explicit DepthCamera(const CameraModel& model);

  const CameraModel& model() const { return model_; }

  /// One point a pixel, row by row, in the camera's optical frame (x right, y down, z forward; m).
  /// `depths` are distances along z, m; what is not a positive number gives (0, 0, 0), no return,
  /// as do pixels that the distortion leaves without a ray.
  std::vector<Point> points(std::span<const float> depths) const;

 private:
  CameraModel model_;
  std::vector<std::array<float, 2>> rays_;  // x/z, y/z; NaN where there is none
};

}  // namespace adit
