// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "adit/slam/core/types.hpp"

namespace adit {

/// A map seen from above as an SVG file: each cell coloured by the highest point in it, the path
/// over it, title, legend, axes and scale bar; light or dark as the reader prefers. x to the right,
/// y up. At most a few hundred cells a side, so the file is small whatever the map.
std::string map_picture(std::span<const Point> points, std::span<const StampedPose> path,
                        const std::string& title = "Map from above");

}  // namespace adit
