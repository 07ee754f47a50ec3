// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// OGC GeoPackage 1.3: an SQLite database with tables of its own and geometries as blobs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Geometry>

#include "adit/tools/containers/sqlite_database.hpp"

namespace adit {

/// Of the coordinates of a GeoPackage's layers.
struct GeoPackageSystem {
  int epsg = 0;  ///< 4326 is longitude and latitude; kUndefinedPlane: metres of no known place
  std::string name{};
  std::string wkt{};
};
inline constexpr int kGeodeticSystem = 4326;
inline constexpr int kUndefinedPlane = -1;

/// Layers with geometries in three dimensions, as one transaction. What is not finished is no
/// GeoPackage.
class GeoPackage {
 public:
  /// Replaces the file. Throws what SqliteDatabase throws.
  GeoPackage(const std::filesystem::path& file, const GeoPackageSystem& system);

  const SqliteDatabase& database() const { return database_; }

  /// Geometries as blobs.
  std::string point(const Eigen::Vector3d& place) const;
  std::string line(std::span<const Eigen::Vector3d> places) const;

  /// `columns`: as SQL, besides `fid` and `geom`.
  void create_layer(const std::string& name, const std::string& columns) const;
  /// `type`: POINT, LINESTRING. `changed`: when, as ISO 8601.
  void register_layer(const std::string& name, const std::string& type,
                      const std::string& description, const Eigen::AlignedBox2d& box,
                      const std::string& changed) const;
  void finish() const { database_.execute("COMMIT"); }

 private:
  void add_system(const std::string& name, int id, std::string_view organization, int code,
                  const std::string& definition) const;

  SqliteDatabase database_;
  int reference_system_;
};

/// To bind a geometry.
inline std::span<const std::byte> as_blob(const std::string& bytes) {
  return std::as_bytes(std::span(bytes.data(), bytes.size()));
}

}  // namespace adit
