// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a raster lies, as GeoTIFF files and world files state it.
#pragma once

#include <cstdint>
#include <string>

#include <Eigen/Core>

#include "adit/tools/drawing/geotiff_writer.hpp"
#include "adit/tools/map_products/product_coordinates.hpp"

namespace adit {

struct RasterFrame {
  int64_t columns = 0;
  int64_t rows = 0;
  double cell = 1.0;                                 ///< m
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();  ///< m, upper left
};

/// `description`: of the cells' values, for people.
GeoTiffHeading geotiff_heading(const RasterFrame& frame, const ProductCoordinates& coordinates,
                               const std::string& description);

/// The six numbers of a world file: the size of a cell, and the middle of the upper left one.
std::string world_file(const RasterFrame& frame);

}  // namespace adit
