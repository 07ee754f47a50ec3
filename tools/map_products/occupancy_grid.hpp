// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A map as robots that drive on a floor know it: what is free, occupied and unknown.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "adit/slam/submaps/keyframe_submap.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_products/cell_grid.hpp"
#include "adit/tools/map_products/cloud_selection.hpp"
#include "adit/tools/map_products/product_coordinates.hpp"

namespace adit {

struct OccupancyGridConfig {
  double cell = 0.05;  ///< m
  /// What stands in the way: heights above the sensor that saw it, m. Lower points are ground.
  double low = -0.3;
  double high = 0.3;
};

/// Cells row by row, from the lowest x and y on.
struct OccupancyCells {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< m, the corner of the first cell
  std::size_t columns = 0;                           ///< along x
  std::size_t rows = 0;                              ///< along y
  std::vector<int8_t> values{};                      ///< 0 free, 100 occupied, -1 unknown
};

/// Cells with static points of these heights are occupied. Free are others that such a point was
/// seen across, from no more than 30 m, or that have ground in them. z must be up.
class OccupancyGrid {
 public:
  explicit OccupancyGrid(const OccupancyGridConfig& config) : config_(config), grid_(config.cell) {}

  /// Of the selection only what has moved matters: it stands in nobody's way.
  void add(const MapKeyframe& keyframe, const KeyframeSubmap& submap,
           const ProductCoordinates& coordinates, const CloudSelection& selection);

  bool empty() const { return grid_.empty(); }
  int64_t columns() const { return grid_.columns(); }
  int64_t rows() const { return grid_.rows(); }

  double cell() const { return config_.cell; }
  /// Those whose x and y lie within so many metres of a place.
  OccupancyCells cells_around(const Eigen::Vector2d& place, double reach) const;
  /// As ROS map_server reads it: PGM with 0 for occupied, 254 for free and 205 for unknown.
  void write_pgm(const std::filesystem::path& file) const;
  std::string yaml(const std::string& picture) const;

 private:
  enum class State : uint8_t { unknown, free, occupied };
  using Grid = CellGrid<State>;

  void mark(const Grid::Index& index, State state);
  void mark_free_between(const Eigen::Vector3d& sensor, const Eigen::Vector3d& end);

  OccupancyGridConfig config_;
  Grid grid_;
};

}  // namespace adit
