// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "adit/slam/core/types.hpp"

namespace adit {

/// The graph of a map seen from above, m.
struct PictureGraph {
  struct Link {
    Eigen::Vector2d from;
    Eigen::Vector2d to;
    bool revoked = false;
  };
  std::vector<Eigen::Vector2d> keyframes{};
  std::vector<Link> loops{};
  bool north_up = false;  ///< y is north, and an arrow says so
};

enum class PictureFormat { svg, png };

/// A map seen from above as a file of that format: each cell coloured by the highest point in it,
/// the path and the graph over it, title, legend, grid, axes and scale bar; an SVG is light or dark
/// as the reader prefers. x to the right, y up. At most a few hundred cells a side, so the file is
/// small whatever the map.
std::string map_picture(std::span<const Point> points, std::span<const StampedPose> path,
                        const std::string& title = "Map from above", const PictureGraph& graph = {},
                        PictureFormat format = PictureFormat::svg);

}  // namespace adit
