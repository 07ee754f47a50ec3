// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Cameras whose images are beside the sweeps of a recording: in its messages, or in a folder.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <Eigen/Geometry>

#include "adit/slam/core/camera_model.hpp"
#include "adit/slam/core/types.hpp"
#include "adit/tools/cameras/color_image.hpp"

namespace adit {

/// The images of one camera, of which memory holds one at a time.
class ImageSeries {
 public:
  ImageSeries() = default;
  virtual ~ImageSeries() = default;
  ImageSeries(const ImageSeries&) = delete;
  ImageSeries& operator=(const ImageSeries&) = delete;

  /// When they were taken, ascending.
  virtual std::span<const Nanoseconds> stamps() const = 0;
  /// Reads one of them. Throws InputError where it is damaged.
  virtual ColorImage image(std::size_t index) const = 0;
};

/// A camera with its images.
struct CameraSource {
  std::string name;   ///< for people: the topic, or what its file calls it
  CameraModel model;  ///< of the images
  std::string frame;  ///< of the transforms; empty: unknown
  /// Where it is mounted, from its optical frame; none: by the recording's transforms of `frame`.
  std::optional<Eigen::Isometry3d> T_lidar_camera{};
  /// Where it is mounted against the inertial sensor, of calibrations that relate it to that one
  /// (Kalibr's); none: by the above.
  std::optional<Eigen::Isometry3d> T_imu_camera{};
  double time_offset = 0.0;  ///< s that images were taken after their stamps
  std::shared_ptr<const ImageSeries> images;
};

}  // namespace adit
