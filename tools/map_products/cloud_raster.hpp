// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A cloud seen from above: a number a cell.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include <Eigen/Core>

#include "adit/tools/drawing/geotiff_writer.hpp"
#include "adit/tools/map_products/cell_grid.hpp"
#include "adit/tools/map_products/cloud_selection.hpp"
#include "adit/tools/map_products/product_coordinates.hpp"
#include "adit/tools/map_products/raster_frame.hpp"
#include "adit/tools/map_products/tiled_cloud.hpp"

namespace adit {

enum class RasterValue {
  height,     ///< m, of the highest point
  intensity,  ///< mean, the sensor's own scale
  points,     ///< how many there are
  ground,     ///< m, of the points that are given: those of the ground
};

/// Only parts with points in them take memory. Borders of cells are at multiples of their size.
class CloudRaster {
 public:
  static constexpr const char* kThings = "points";  ///< what filled cells have

  /// `cell`: m.
  CloudRaster(RasterValue value, double cell) : value_(value), grid_(cell) {}

  /// Points that are moving count for nothing.
  void add(std::span<const CloudPoint> points);

  bool empty() const { return grid_.empty(); }
  int64_t columns() const { return grid_.columns(); }
  int64_t rows() const { return grid_.rows(); }
  RasterFrame frame() const {
    return {.columns = columns(), .rows = rows(), .cell = grid_.size(), .corner = corner()};
  }
  /// NaN where there is no point. Column from the left, row from the top.
  float at(int64_t column, int64_t row) const;
  uint64_t filled() const { return filled_; }

  /// A GeoTIFF of 32-bit numbers. Throws OutputError.
  void write_tiff(const std::filesystem::path& file, const ProductCoordinates& coordinates) const;
  /// A picture. Colours go from the value that 2 % are below to that which 2 % are above; clear
  /// where there is no point.
  std::string png() const;

 private:
  struct Cell {
    float sum = 0.0F;
    uint32_t count = 0;
  };
  float value_of(const Cell& cell) const;
  Eigen::Vector2d corner() const;  // upper left, m

  RasterValue value_;
  CellGrid<Cell> grid_;
  uint64_t filled_ = 0;
};

}  // namespace adit
