// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/geopackage.hpp"

#include <system_error>

#include <fmt/core.h>

#include "adit/tools/map_products/product_coordinates.hpp"
#include "adit/tools/support/raw_bytes.hpp"

namespace adit {
namespace {

constexpr int kApplication = 0x47504B47;  // "GPKG"
constexpr int kGeoPackageVersion = 10300;
constexpr uint32_t kPointZ = 1001;
constexpr uint32_t kLineStringZ = 1002;

/// A geometry: the GeoPackage's header without an envelope, and well-known binary.
std::string geometry(int reference_system, uint32_t type, std::span<const Eigen::Vector3d> places) {
  std::string bytes = "GP";
  append_raw(bytes, uint8_t{0});  // version
  append_raw(bytes, uint8_t{1});  // little-endian
  append_raw(bytes, reference_system);
  append_raw(bytes, uint8_t{1});
  append_raw(bytes, type);
  if (type == kLineStringZ) {
    append_raw(bytes, static_cast<uint32_t>(places.size()));
  }
  for (const Eigen::Vector3d& place : places) {
    append_raw(bytes, place.x());
    append_raw(bytes, place.y());
    append_raw(bytes, place.z());
  }
  return bytes;
}

/// SQLite opens what is there; a GeoPackage begins empty.
const std::filesystem::path& removed(const std::filesystem::path& file) {
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  return file;
}

}  // namespace

GeoPackage::GeoPackage(const std::filesystem::path& file, const GeoPackageSystem& system)
    : database_(removed(file), SqliteDatabase::Mode::create), reference_system_(system.epsg) {
  // In a journal of its own the file would be written twice; it takes its place once it is whole.
  database_.execute("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF");
  database_.execute(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}",
                                kApplication, kGeoPackageVersion));
  database_.execute("BEGIN");
  database_.execute(
      "CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT NOT NULL, srs_id INTEGER PRIMARY KEY, "
      "organization TEXT NOT NULL, organization_coordsys_id INTEGER NOT NULL, definition TEXT "
      "NOT NULL, description TEXT)");
  database_.execute(
      "CREATE TABLE gpkg_contents (table_name TEXT NOT NULL PRIMARY KEY, data_type TEXT NOT "
      "NULL, identifier TEXT UNIQUE, description TEXT DEFAULT '', last_change DATETIME NOT NULL "
      "DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ','now')), min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, "
      "max_y DOUBLE, srs_id INTEGER, CONSTRAINT fk_gc_r_srs_id FOREIGN KEY (srs_id) REFERENCES "
      "gpkg_spatial_ref_sys(srs_id))");
  database_.execute(
      "CREATE TABLE gpkg_geometry_columns (table_name TEXT NOT NULL, column_name TEXT NOT NULL, "
      "geometry_type_name TEXT NOT NULL, srs_id INTEGER NOT NULL, z TINYINT NOT NULL, m TINYINT "
      "NOT NULL, CONSTRAINT pk_geom_cols PRIMARY KEY (table_name, column_name), CONSTRAINT "
      "uk_gc_table_name UNIQUE (table_name), CONSTRAINT fk_gc_tn FOREIGN KEY (table_name) "
      "REFERENCES gpkg_contents(table_name), CONSTRAINT fk_gc_srs FOREIGN KEY (srs_id) "
      "REFERENCES gpkg_spatial_ref_sys(srs_id))");
  add_system("Undefined Cartesian", -1, "NONE", -1, "undefined");
  add_system("Undefined geographic", 0, "NONE", 0, "undefined");
  add_system("WGS 84", kGeodeticSystem, "EPSG", kGeodeticSystem, geographic_wkt());
  if (reference_system_ != kGeodeticSystem && reference_system_ != kUndefinedPlane) {
    add_system(system.name, reference_system_, "EPSG", reference_system_, system.wkt);
  }
}

std::string GeoPackage::point(const Eigen::Vector3d& place) const {
  return geometry(reference_system_, kPointZ, {&place, 1});
}

std::string GeoPackage::line(std::span<const Eigen::Vector3d> places) const {
  return geometry(reference_system_, kLineStringZ, places);
}

void GeoPackage::create_layer(const std::string& name, const std::string& columns) const {
  database_.execute("CREATE TABLE " + name +
                    " (fid INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, geom BLOB, " + columns +
                    ")");
}

void GeoPackage::register_layer(const std::string& name, const std::string& type,
                                const std::string& description, const Eigen::AlignedBox2d& box,
                                const std::string& changed) const {
  SqliteStatement content =
      database_.prepare("INSERT INTO gpkg_contents VALUES (?, 'features', ?, ?, ?, ?, ?, ?, ?, ?)");
  content.bind(1, std::string_view(name)).bind(2, std::string_view(name));
  content.bind(3, std::string_view(description)).bind(4, std::string_view(changed));
  if (!box.isEmpty()) {
    content.bind(5, box.min().x()).bind(6, box.min().y());
    content.bind(7, box.max().x()).bind(8, box.max().y());
  }
  content.bind(9, int64_t{reference_system_}).step();
  SqliteStatement column =
      database_.prepare("INSERT INTO gpkg_geometry_columns VALUES (?, 'geom', ?, ?, 1, 0)");
  column.bind(1, std::string_view(name)).bind(2, std::string_view(type));
  column.bind(3, int64_t{reference_system_}).step();
}

void GeoPackage::add_system(const std::string& name, int id, std::string_view organization,
                            int code, const std::string& definition) const {
  SqliteStatement row =
      database_.prepare("INSERT INTO gpkg_spatial_ref_sys VALUES (?, ?, ?, ?, ?, NULL)");
  row.bind(1, std::string_view(name)).bind(2, int64_t{id}).bind(3, organization);
  row.bind(4, int64_t{code}).bind(5, std::string_view(definition)).step();
}

}  // namespace adit
