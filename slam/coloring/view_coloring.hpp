// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Colours of points out of images: which points a camera sees, by a depth image of the map's
// surfaces, and what the images that see one agree on (docs/theory/coloring.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "adit/engine/buffer.hpp"
#include "adit/engine/kernels/coloring.hpp"
#include "adit/slam/core/camera_model.hpp"

namespace adit {

/// A camera as the kernels have it, but for its place.
struct LensTable {
  gpu::ViewCamera camera;    ///< without T_camera_local
  std::vector<float> radii;  ///< gpu::kLensSteps + 1
};
LensTable lens_table(const CameraModel& camera);

/// The size of a camera's depth images, and the rays of their pixels.
struct DepthGrid {
  uint32_t width = 0;
  uint32_t height = 0;
  double pixels = 1.0;            ///< of the image, in one of these
  std::vector<gpu::vec3> rays{};  ///< unit length; zero where the lens has none
};
DepthGrid depth_grid(const CameraModel& camera);

/// The camera at a place. `local` are the points' coordinates: the map's axes, from `origin` on.
gpu::ViewCamera placed_camera(const gpu::ViewCamera& camera, const Eigen::Isometry3d& T_map_camera,
                              const Eigen::Vector3d& origin);

/// What the images that see a point say of it.
struct SeenColor {
  std::array<uint8_t, 3> color{};  ///< red, green, blue
  uint8_t sightings = 0;           ///< images; 0: none sees it
};

class ViewColoring {
 public:
  explicit ViewColoring(engine::Context& context);

  /// A camera on the device.
  struct Camera {
    CameraModel model;
    gpu::ViewCamera lens;
    uint32_t depth_width = 0;
    uint32_t depth_height = 0;
    double depth_pixels = 1.0;
    engine::Buffer radii;
    engine::Buffer rays;
  };
  std::shared_ptr<const Camera> make_camera(const CameraModel& model) const;

  /// Surfaces of a part of the map on the device. They are discs of one radius.
  struct Surfaces {
    Eigen::Vector3d origin;  ///< m, map frame: of their coordinates, which have the map's axes
    uint32_t count = 0;
    engine::Buffer elements;
  };
  /// At least one.
  std::shared_ptr<const Surfaces> make_surfaces(const Eigen::Vector3d& origin,
                                                std::span<const gpu::ViewSurface> elements) const;

  /// An image, with how far away what it shows is.
  struct View {
    std::shared_ptr<const Camera> camera;
    engine::Buffer image;
    engine::Buffer depth;

    uint64_t bytes() const { return image.size() + depth.size(); }
  };
  /// `rgb`: three bytes a pixel, as many as the camera has; std::logic_error otherwise.
  /// `radius`: of the surfaces, m.
  std::shared_ptr<const View> make_view(const std::shared_ptr<const Camera>& camera,
                                        const Eigen::Isometry3d& T_map_camera,
                                        std::span<const uint8_t> rgb,
                                        std::span<const std::shared_ptr<const Surfaces>> surfaces,
                                        double radius) const;

  /// How a view is looked at.
  struct Look {
    std::shared_ptr<const View> view;
    Eigen::Isometry3d T_map_camera;                  ///< all but that which its depths are of
    std::array<float, 3> gain = {1.0F, 1.0F, 1.0F};  ///< of red, green and blue
  };
  /// Colours of points, map frame, m, which lie around `origin`. A point that is farther behind
  /// what a view sees there than `tolerance` (m) is hidden.
  std::vector<SeenColor> colors(std::span<const Eigen::Vector3d> points,
                                const Eigen::Vector3d& origin, std::span<const Look> looks,
                                double tolerance) const;

 private:
  std::vector<SeenColor> colors_at_once(std::span<const Eigen::Vector3d> points,
                                        const Eigen::Vector3d& origin, std::span<const Look> looks,
                                        double tolerance) const;
  engine::Buffer image_on_device(const Camera& camera, std::span<const uint8_t> rgb) const;

  engine::Context* context_;
  engine::Coloring kernels_;
};

}  // namespace adit
