// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adit/tools/setup/device_session.hpp"

namespace adit {

/// What `adit export` is asked to write: one of trajectory, graph, cloud, dense, tiles, raster,
/// elevation, grid, slice, section, plan, contours, report, picture and dump is set; tiles and
/// cloud go together.
struct ExportCommandOptions {
  std::filesystem::path map{};
  std::optional<std::filesystem::path> output{};     ///< none: standard output, for the dump alone
  std::string trajectory{};                          ///< tum, kitti, csv, geojson, kml, gpkg
  std::string graph{};                               ///< g2o
  std::string cloud{};                               ///< ply, pcd, las, laz, copc
  std::string dense{};                               ///< ply, pcd, las, laz, copc
  std::optional<std::filesystem::path> recording{};  ///< for dense, colours; none: that of the map
  bool color = false;                                ///< of points: by the images of cameras
  std::vector<std::string> cameras{};                ///< topics of images; empty: all
  std::optional<std::filesystem::path> calibration{};  ///< a file of cameras
  bool as_calibrated = false;          ///< cameras' mountings and clocks are not looked into
  std::optional<double> resolution{};  ///< m, one point of the cloud a voxel
  bool picture = false;
  bool dump = false;
  uint64_t max_ram_bytes = 0;        ///< that may be resident; 0: no limit
  std::optional<double> tiles{};     ///< m, the side of a square; output is a folder
  std::string frame{};               ///< map, local, utm, geodetic; empty: by the format
  std::optional<std::string> utm{};  ///< "30N"; none: the origin's zone
  std::optional<std::string> crs{};  ///< a projected system by name: "EPSG:25830"
  std::optional<std::filesystem::path> geoid{};  ///< heights are above it; none: the ellipsoid
  std::optional<std::string> origin{};           ///< "LAT,LON,ALT[,YAW]": places the map by hand
  std::string box{};                             ///< "X0,Y0,X1,Y1", m; empty: everywhere
  std::optional<std::filesystem::path> polygon{};
  std::vector<int64_t> sessions{};  ///< empty: all
  std::optional<double> from{};     ///< s, stamps
  std::optional<double> until{};
  bool without_moving = false;
  bool without_gone = false;         ///< by what later sessions, up to `until`, see through
  bool find_moving = false;          ///< by the rays of all submaps, on the device
  bool classify = false;             ///< points of the ground are a class
  std::string clean{};               ///< mark, drop; empty: noise is not looked for
  std::string raster{};              ///< height, intensity, ground, color
  bool report = false;               ///< a page for whoever takes delivery
  bool elevation = false;            ///< ground, slope, steps and roughness
  bool grid = false;                 ///< occupancy grid of ROS map_server
  std::optional<double> cell{};      ///< m, of rasters and grids
  std::string slice{};               ///< "HEIGHT[,THICKNESS]", m
  std::string section{};             ///< "X0,Y0,X1,Y1[,THICKNESS]", m
  bool plan = false;                 ///< a floor plan a storey
  std::optional<double> contours{};  ///< m, between lines of one height of the ground
  std::string heights{};             ///< "LOW,HIGH", m above the sensor: what stands in the way
  DeviceOptions device{};            ///< for find_moving
};

}  // namespace adit
