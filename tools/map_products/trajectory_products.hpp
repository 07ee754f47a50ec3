// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The trajectory of a georeferenced map as programs of the field read it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_products/cloud_selection.hpp"
#include "adit/tools/map_products/product_coordinates.hpp"

namespace adit {

/// A sweep of a map.
struct MapSweep {
  SessionId session = 0;
  NodeId keyframe = 0;
  Nanoseconds stamp{0};
  Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();
  bool merged = false;  ///< its points are in the submap
};

/// Sweeps in the order of keyframes, and where a part begins that nothing ties to what comes
/// before.
struct MapPath {
  std::vector<MapSweep> sweeps;
  std::vector<std::size_t> parts;
};
/// Those that are wanted by session and time. Throws InputError where the map is damaged.
MapPath map_path(const MapDatabase& map, const CloudSelection& selection);

/// Each writes the file and returns the number of poses. Throw OutputError.
///
/// CSV: a line a sweep with its pose in the map's frame, and where the map is georeferenced the
/// place in the local frame, geodetic and in UTM, and in a named system and above a geoid where
/// there are these.
std::size_t write_trajectory_csv(const std::filesystem::path& file, const MapPath& path,
                                 const std::optional<ProductCoordinates>& earth);
/// GeoJSON (RFC 7946): a LineString a part, and a Point a keyframe.
std::size_t write_trajectory_geojson(const std::filesystem::path& file, const MapPath& path,
                                     const MapDatabase& map, const ProductCoordinates& earth);
/// KML: a gx:Track a part where stamps are UNIX times, else a LineString.
std::size_t write_trajectory_kml(const std::filesystem::path& file, const MapPath& path,
                                 const std::string& name, const ProductCoordinates& earth);
/// GeoPackage 1.3: layers `keyframes`, `trajectory` and `edges`, in UTM or a named system where the
/// coordinates are, else geodetic (EPSG:4326, heights above the ellipsoid).
std::size_t write_trajectory_geopackage(const std::filesystem::path& file, const MapPath& path,
                                        const MapDatabase& map, const ProductCoordinates& earth);

/// "2026-01-31T12:00:00.000Z" of a UNIX time.
std::string iso_time(Nanoseconds unix_time);

}  // namespace adit
