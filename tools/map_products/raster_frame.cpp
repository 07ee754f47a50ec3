// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/raster_frame.hpp"

#include "adit/slam/core/text.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {

GeoTiffHeading geotiff_heading(const RasterFrame& frame, const ProductCoordinates& coordinates,
                               const std::string& description) {
  GeoTiffHeading heading{.columns = frame.columns,
                         .rows = frame.rows,
                         .cell = frame.cell,
                         .corner = frame.corner,
                         .coordinates = coordinates.name(),
                         .description = description,
                         .software = "adit " + std::string(version())};
  if (const std::optional<int> epsg = coordinates.epsg()) {
    heading.epsg = *epsg;
  } else if (coordinates.frame() == ProductFrame::local) {
    const WorldFrame& world = coordinates.world();
    heading.projection = {.latitude = world.origin().latitude,
                          .longitude = world.origin().longitude,
                          .scale = world.scale()};
  }
  return heading;
}

std::string world_file(const RasterFrame& frame) {
  const Eigen::Vector2d middle = frame.corner + 0.5 * frame.cell * Eigen::Vector2d(1.0, -1.0);
  return shortest(frame.cell) + "\n0\n0\n" + shortest(-frame.cell) + "\n" + shortest(middle.x()) +
         "\n" + shortest(middle.y()) + "\n";
}

}  // namespace adit
