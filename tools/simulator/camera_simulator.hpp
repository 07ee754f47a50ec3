// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "adit/slam/core/camera_model.hpp"
#include "adit/slam/core/checkpoint.hpp"
#include "adit/slam/core/types.hpp"
#include "adit/tools/cameras/color_image.hpp"
#include "adit/tools/simulator/scene_caster.hpp"
#include "adit/tools/simulator/spline.hpp"

namespace adit {

/// An image and its stamp.
struct SimulatedImage {
  Nanoseconds stamp{0};
  ColorImage image;
};

/// How a camera is carried.
struct CameraMount {
  const SplineTrajectory* trajectory = nullptr;
  Eigen::Isometry3d T_body_camera = Eigen::Isometry3d::Identity();  ///< from its optical frame
};

/// The directions of all pixels, row by row, of unit length; zero where the lens shows nothing. The
/// same bits on every machine, unlike CameraProjection::ray(), which uses the C library.
std::vector<Eigen::Vector3d> pixel_rays(const CameraProjection& camera);

/// A camera with a global shutter, which takes an image in no time: each pixel has the colour of
/// the surface that its ray meets, or of the sky. It looks through glass. There is no light, so
/// surfaces have no shading and no shadows.
class CameraSimulator {
 public:
  /// Scene and trajectory must outlive it. `seed` is that of the surfaces' colours.
  CameraSimulator(const SceneCaster& scene, const CameraModel& camera, const CameraMount& mount,
                  uint64_t seed);

  /// What it sees at a time (s from the start of the recording). The same whatever the number of
  /// threads.
  ColorImage image(double time, const Checkpoint& checkpoint = {}) const;

  /// T_world_camera, of the optical frame, at a time in s.
  Eigen::Isometry3d pose(double time) const {
    return mount_.trajectory->pose(time) * mount_.T_body_camera;
  }

  const CameraModel& camera() const { return camera_; }

 private:
  struct Moment {
    Eigen::Vector3d origin;  ///< of the rays, world
    double time = 0.0;       ///< s
    std::vector<Mover> movers;
  };

  SurfaceColor seen(const Moment& moment, const Eigen::Vector3d& direction) const;

  const SceneCaster* scene_;
  CameraModel camera_;
  CameraMount mount_;
  uint64_t seed_;
  std::vector<Eigen::Vector3d> rays_;
};

}  // namespace adit
