// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Depth images as sweeps: each pixel's depth along the ray that the camera sees it by.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "adit/slam/core/camera_model.hpp"
#include "adit/slam/core/types.hpp"

namespace adit {

/// The rays of a camera's pixels, worked out once.
class DepthCamera {
 public:
  explicit DepthCamera(const CameraModel& model);

  const CameraModel& model() const { return model_; }

  /// One point a pixel, row by row, in the camera's optical frame (x right, y down, z forward; m).
  /// `depths` are distances along z, m; what is not a positive number gives (0, 0, 0), no return,
  /// as do pixels without a ray, and those of a fisheye that look sideways or back.
  std::vector<Point> points(std::span<const float> depths) const;

 private:
  CameraModel model_;
  std::vector<std::array<float, 2>> rays_;  // x/z, y/z; NaN where there is none
};

}  // namespace adit
