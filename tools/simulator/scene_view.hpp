// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What pictures of scenes share: colours, and the view from above.
#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Geometry>

#include "adit/slam/core/checkpoint.hpp"
#include "adit/tools/drawing/png_writer.hpp"
#include "adit/tools/simulator/ray_scene.hpp"
#include "adit/tools/simulator/scene.hpp"

namespace adit {

inline constexpr Color kSkyColor{214, 226, 238};

/// A surface in daylight; `fading` 1 is lost in the haze.
Color shaded(const RayHit& hit, double fading);

/// From a colour (0) to another (1).
Color mixed(const Color& from, const Color& to, double share);

/// The rectangle that a view from above shows, on the upper rows of an image.
struct Plan {
  /// A plan of `box`, as wide as the image and at most `most_rows` high.
  Plan(const Eigen::AlignedBox3d& box, int width_px, int most_rows);

  Eigen::AlignedBox3d area;  ///< m, world
  double scale = 1.0;        ///< m a pixel
  int width = 0;             ///< px
  int height = 0;            ///< px

  Eigen::Vector2i pixel(const Eigen::Vector3d& at) const;
  bool holds(const Eigen::Vector2i& pixel) const;
};

/// Draws the scene from above, cut open 1.8 m above the floor of the route where it has a ceiling.
/// `floor` in m; NaN: that of the part of the route that is nearest.
void draw_plan(Image& image, const Plan& plan, const Scene& scene, const RayScene& still,
               double floor, const Checkpoint& checkpoint);

}  // namespace adit
