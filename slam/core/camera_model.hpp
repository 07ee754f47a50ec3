// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include <Eigen/Core>

namespace adit {

/// How a lens bends what comes in at an angle.
enum class Lens {
  /// x/z and y/z, then the Brown-Conrady distortion with its rational part: OpenCV's `calib3d`, and
  /// plumb_bob and rational_polynomial of ROS. Sees less than half a turn.
  perspective,
  /// The angle to the axis, then a polynomial of it (Kannala and Brandt 2006): OpenCV's `fisheye`,
  /// and equidistant of ROS and Kalibr.
  fisheye,
};

/// A camera's calibration, as OpenCV and ROS define it. Its optical frame: x right, y down, z
/// forward, m. Pixel (0, 0) is the middle of the upper left one.
struct CameraModel {
  std::size_t width = 0;   ///< pixels
  std::size_t height = 0;  ///< pixels
  double fx = 0.0;         ///< pixels
  double fy = 0.0;         ///< pixels
  double cx = 0.0;         ///< pixels
  double cy = 0.0;         ///< pixels
  /// Perspective: k1 k2 p1 p2 k3 k4 k5 k6. Fisheye: k1 k2 k3 k4. Zeros: no distortion.
  std::array<double, 8> distortion{};
  Lens lens = Lens::perspective;  ///< which the distortion is of
};

/// The radius, of x/z and y/z or (fisheye) the angle to the axis, up to which the image's radius
/// grows with it. Farther out the distortion's polynomial turns back, and the image shows something
/// else there.
double widest_radius(const CameraModel& camera);

/// Points to pixels and back.
class CameraProjection {
 public:
  explicit CameraProjection(const CameraModel& camera);

  const CameraModel& camera() const { return camera_; }
  /// widest_radius() of the camera.
  double widest() const { return widest_; }

  /// The pixel that shows a point of the optical frame, m; it may lie outside of the image. None
  /// where the lens does not see in that direction.
  std::optional<Eigen::Vector2d> pixel(const Eigen::Vector3d& point) const;

  /// The angle (rad) to the axis of what a fisheye shows at a pixel. None where it shows nothing.
  std::optional<double> angle(const Eigen::Vector2d& pixel) const;

  /// The direction of what a pixel shows, unit length. None where the lens has no ray for it.
  std::optional<Eigen::Vector3d> ray(const Eigen::Vector2d& pixel) const;

 private:
  CameraModel camera_;
  double widest_;
};

}  // namespace adit
