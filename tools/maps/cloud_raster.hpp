// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A cloud seen from above: a number a cell.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "adit/tools/maps/cloud_selection.hpp"
#include "adit/tools/maps/product_coordinates.hpp"
#include "adit/tools/maps/tiled_cloud.hpp"

namespace adit {

enum class RasterValue {
  height,     ///< m, of the highest point
  intensity,  ///< mean, the sensor's own scale
};

/// Only blocks with points in them take memory. Borders of cells are at multiples of their size.
class CloudRaster {
 public:
  /// `cell`: m.
  CloudRaster(RasterValue value, double cell) : value_(value), cell_(cell) {}

  /// Points that are moving count for nothing.
  void add(std::span<const CloudPoint> points);

  bool empty() const { return blocks_.empty(); }
  int64_t columns() const { return high_.x() - low_.x() + 1; }
  int64_t rows() const { return high_.y() - low_.y() + 1; }
  /// The upper left corner, m.
  Eigen::Vector2d corner() const;
  /// NaN where there is no point. Column from the left, row from the top.
  float at(int64_t column, int64_t row) const;
  uint64_t filled() const { return filled_; }

  /// A GeoTIFF of 32-bit numbers. Throws OutputError.
  void write_tiff(const std::filesystem::path& file, const ProductCoordinates& coordinates) const;
  /// A picture, and how it lies as world file: its six numbers. Colours go from the value that 2 %
  /// are below to that which 2 % are above; clear where there is no point.
  std::string png() const;
  std::string world_file() const;

 private:
  using Index = Eigen::Matrix<int64_t, 2, 1>;
  struct Cell {
    float sum = 0.0F;
    uint32_t count = 0;
  };
  Index index_of(const Eigen::Vector2d& place) const;
  float value_of(const Cell& cell) const;

  RasterValue value_;
  double cell_;
  std::map<TileNumber, std::vector<Cell>> blocks_;
  Index low_ = Index::Zero();
  Index high_ = Index::Zero();
  uint64_t filled_ = 0;
};

}  // namespace adit
