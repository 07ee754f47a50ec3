// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "adit/tools/drawing/png_writer.hpp"

namespace adit {

/// What is drawn of a cloud.
struct OverlayCloud {
  std::vector<Eigen::Vector3f> points;  ///< m, in the cloud's own frame, z up
  std::vector<Eigen::Vector3f> walls;   ///< those on steep surfaces
};

/// How much of a place is shown, m: from above a square of twice `reach`, and below it from the
/// side what lies in a strip along x, `reach` / 2 high.
struct OverlayView {
  Eigen::Vector3f center = Eigen::Vector3f::Zero();  ///< m, in the first cloud's frame
  float reach = 10.0F;
};

/// A view that shows most of both.
OverlayView view_of(const OverlayCloud& first, const OverlayCloud& second,
                    const Eigen::Isometry3d& T_first_second);

/// Two clouds, one upon the other, in the first one's frame: from above their walls (all points
/// where there are hardly any), from the side all points of a strip. The first is blue, the second
/// vermilion, what both have is dark.
Image overlay_picture(const OverlayCloud& first, const OverlayCloud& second,
                      const Eigen::Isometry3d& T_first_second, const OverlayView& view);

}  // namespace adit
