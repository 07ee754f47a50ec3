// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Surveyed points from a table, and a map adjusted to them (docs/georeferencing.md).
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "adit/slam/gnss/ground_control.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_products/product_coordinates.hpp"

namespace adit {

/// A line of the table.
struct MarkedPoint {
  ControlPoint point{};  ///< its keyframe and place in it are not known yet
  Eigen::Vector3d p_map = Eigen::Vector3d::Zero();  ///< where it was marked, m
  std::size_t line = 0;
};

/// Reads a table (CSV) with the columns name, role (control or check), x_m, y_m and z_m (the mark,
/// in the map's frame) and the surveyed place: latitude_deg, longitude_deg and altitude_m (above
/// the ellipsoid), or easting_m, northing_m and height_m in `system` (which has a zone of UTM or a
/// named system then; heights are above its geoid, where it has one). sigma_m and sigma_up_m
/// (standard deviations of place and mark together) may be there. Throws InputError.
std::vector<MarkedPoint> read_control(const std::filesystem::path& file,
                                      const ProductSystem& system);

/// Points with how far the map has them from where they lie: east, north, up, m.
struct ControlTable {
  std::vector<ControlPoint> points{};
  std::vector<Eigen::Vector3d> errors{};
};

/// Of the points that a map keeps; none of a map without a place.
ControlTable control_table(const MapDatabase& map);

/// How far places lie off, root mean square level and upwards.
struct PlaceSpread {
  std::size_t count = 0;
  double level = 0.0;    ///< m
  double up = 0.0;       ///< m
  double largest = 0.0;  ///< m, in space
};
/// Of errors east, north and up, m; nothing where there are none.
std::optional<PlaceSpread> spread_of(std::span<const Eigen::Vector3d> errors);
/// Of the points of one role.
std::optional<PlaceSpread> spread_of(const ControlTable& table, ControlRole role);
nlohmann::ordered_json to_json(const PlaceSpread& spread);

/// What a map becomes with the points of a table in place of those that it had.
struct ControlAdjustment {
  ControlTable table{};                   ///< after
  std::vector<Eigen::Vector3d> before{};  ///< errors before
  bool was_placed = false;                ///< the map had a place on the Earth
  GroundControl found{};
};

/// Nothing is written. Throws InputError: of the table; where a mark lies where no submap is; where
/// the map cannot be adjusted to its points.
ControlAdjustment adjust_to_control(const MapDatabase& map, const std::filesystem::path& table,
                                    const ProductSystem& system,
                                    const std::function<bool(const OptimizationStep&)>& on_step);

/// For people, line by line.
std::string describe(const ControlAdjustment& adjustment);
nlohmann::ordered_json to_json(const ControlAdjustment& adjustment);

}  // namespace adit
