// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A map seen from above: a colour a cell.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "adit/tools/map_products/cell_grid.hpp"
#include "adit/tools/map_products/cloud_selection.hpp"
#include "adit/tools/map_products/product_coordinates.hpp"
#include "adit/tools/map_products/raster_frame.hpp"

namespace adit {

/// Only parts with colours take memory. Borders of cells are at multiples of their size.
class ColorRaster {
 public:
  static constexpr const char* kThings = "colours";  ///< what filled cells have

  /// `cell`: m.
  explicit ColorRaster(double cell) : grid_(cell) {}

  /// Points of a surface. A cell has the mean colour of its points that have one; those of a cell
  /// are added at once, one after the other.
  void add(std::span<const CloudPoint> points);

  bool empty() const { return grid_.empty(); }
  RasterFrame frame() const;
  uint64_t filled() const { return filled_; }

  /// Red, green, blue and opacity: 255, or all 0 where there is no colour. Column from the left,
  /// row from the top.
  std::array<uint8_t, 4> at(int64_t column, int64_t row) const;

  /// Four channels of 8 bits. Throws OutputError.
  void write_tiff(const std::filesystem::path& file, const ProductCoordinates& coordinates) const;
  /// A picture, clear where there is no colour.
  std::string png() const;

 private:
  CellGrid<std::array<uint8_t, 4>> grid_;
  uint64_t filled_ = 0;
};

}  // namespace adit
