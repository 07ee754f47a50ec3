// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// OGC GeoPackage 1.3: an SQLite database with tables of its own and geometries as blobs.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <system_error>

#include <fmt/core.h>

#include "adit/tools/clouds/las_writer.hpp"
#include "adit/tools/containers/sqlite_database.hpp"
#include "adit/tools/map_products/trajectory_products.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/raw_bytes.hpp"

namespace adit {
namespace {

constexpr int kApplication = 0x47504B47;  // "GPKG"
constexpr int kVersion = 10300;
constexpr int kGeodetic = 4326;
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

std::span<const std::byte> as_blob(const std::string& bytes) {
  return std::as_bytes(std::span(bytes.data(), bytes.size()));
}

class GeoPackage {
 public:
  GeoPackage(const std::filesystem::path& file, const ProductCoordinates& earth)
      : database_(file, SqliteDatabase::Mode::create),
        earth_(&earth),
        reference_system_(earth.epsg().value_or(kGeodetic)) {
    // In a journal of its own the file would be written twice; it takes its place once it is whole.
    database_.execute("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF");
    database_.execute(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}",
                                  kApplication, kVersion));
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
    add_system("WGS 84", kGeodetic, "EPSG", kGeodetic, geographic_wkt());
    if (reference_system_ != kGeodetic) {
      add_system(earth.plane_name(), reference_system_, "EPSG", reference_system_,
                 earth.plane_wkt());
    }
  }

  const SqliteDatabase& database() const { return database_; }

  Eigen::Vector3d place(const Eigen::Vector3d& p_map) const {
    if (reference_system_ != kGeodetic) {
      return earth_->from_map(p_map);
    }
    const Geodetic geodetic = earth_->place(p_map).geodetic;
    return {geodetic.longitude, geodetic.latitude, geodetic.altitude};
  }
  std::string point(const Eigen::Vector3d& place) const {
    return geometry(reference_system_, kPointZ, {&place, 1});
  }
  std::string line(std::span<const Eigen::Vector3d> places) const {
    return geometry(reference_system_, kLineStringZ, places);
  }

  void create_layer(const std::string& name, const std::string& columns) const {
    database_.execute("CREATE TABLE " + name +
                      " (fid INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, geom BLOB, " + columns +
                      ")");
  }
  void register_layer(const std::string& name, const std::string& type,
                      const std::string& description, const Eigen::AlignedBox2d& box,
                      const std::string& changed) const {
    SqliteStatement content = database_.prepare(
        "INSERT INTO gpkg_contents VALUES (?, 'features', ?, ?, ?, ?, ?, ?, ?, ?)");
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
  void finish() const { database_.execute("COMMIT"); }

 private:
  void add_system(const std::string& name, int id, std::string_view organization, int code,
                  const std::string& definition) const {
    SqliteStatement row =
        database_.prepare("INSERT INTO gpkg_spatial_ref_sys VALUES (?, ?, ?, ?, ?, NULL)");
    row.bind(1, std::string_view(name)).bind(2, int64_t{id}).bind(3, organization);
    row.bind(4, int64_t{code}).bind(5, std::string_view(definition)).step();
  }

  SqliteDatabase database_;
  const ProductCoordinates* earth_;
  int reference_system_;
};

struct Stamps {
  bool unix_times = false;

  void bind(SqliteStatement& row, int parameter, Nanoseconds stamp) const {
    row.bind(parameter, seconds(stamp));
    if (unix_times) {
      row.bind(parameter + 1, std::string_view(iso_time(stamp)));
    }
  }
};

}  // namespace

std::size_t write_trajectory_geopackage(const std::filesystem::path& file, const MapPath& path,
                                        const MapDatabase& map, const ProductCoordinates& earth) {
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  const GeoPackage package(file, earth);
  const Stamps stamps{.unix_times = std::ranges::all_of(path.sweeps, [](const MapSweep& sweep) {
                        return is_unix_time(sweep.stamp);
                      })};
  // The time of the change is that of the data: same map, same bytes.
  const std::string changed = stamps.unix_times && !path.sweeps.empty()
                                  ? iso_time(path.sweeps.back().stamp)
                                  : "1970-01-01T00:00:00.000Z";
  const std::string kHeights = "heights above the WGS 84 ellipsoid, m";

  std::set<NodeId> wanted;
  for (const MapSweep& sweep : path.sweeps) {
    wanted.insert(sweep.keyframe);
  }
  std::map<NodeId, Eigen::Vector3d> places;
  Eigen::AlignedBox2d box;
  package.create_layer("keyframes",
                       "keyframe INTEGER, session INTEGER, stamp_s DOUBLE, time DATETIME");
  SqliteStatement row = package.database().prepare(
      "INSERT INTO keyframes (geom, keyframe, session, stamp_s, time) VALUES (?, ?, ?, ?, ?)");
  for (const MapKeyframe& keyframe : map.keyframes()) {
    if (!wanted.contains(keyframe.id)) {
      continue;
    }
    const Eigen::Vector3d place = package.place(keyframe.T_map_keyframe.translation());
    places.emplace(keyframe.id, place);
    box.extend(Eigen::Vector2d(place.head<2>()));
    row.reset();
    row.bind(1, as_blob(package.point(place))).bind(2, keyframe.id).bind(3, keyframe.session);
    stamps.bind(row, 4, keyframe.stamp);
    row.step();
  }
  package.register_layer("keyframes", "POINT", "nodes of the pose graph; " + kHeights, box,
                         changed);

  package.create_layer(
      "trajectory", "session INTEGER, sweeps INTEGER, first_stamp_s DOUBLE, last_stamp_s DOUBLE");
  row = package.database().prepare(
      "INSERT INTO trajectory (geom, session, sweeps, first_stamp_s, last_stamp_s) VALUES (?, ?, "
      "?, ?, ?)");
  box.setEmpty();
  for (std::size_t begin = 0; begin < path.sweeps.size();) {
    const auto next = std::ranges::upper_bound(path.parts, begin);
    std::size_t end = next == path.parts.end() ? path.sweeps.size() : *next;
    std::vector<Eigen::Vector3d> line;
    for (std::size_t i = begin; i < end; ++i) {
      if (path.sweeps[i].session != path.sweeps[begin].session) {
        end = i;
        break;
      }
      line.push_back(package.place(path.sweeps[i].T_map_lidar.translation()));
      box.extend(Eigen::Vector2d(line.back().head<2>()));
    }
    row.reset();
    row.bind(1, as_blob(package.line(line))).bind(2, path.sweeps[begin].session);
    row.bind(3, static_cast<int64_t>(line.size())).bind(4, seconds(path.sweeps[begin].stamp));
    row.bind(5, seconds(path.sweeps[end - 1].stamp)).step();
    begin = end;
  }
  package.register_layer("trajectory", "LINESTRING", "every sweep; " + kHeights, box, changed);

  package.create_layer("edges", "node_from INTEGER, node_to INTEGER, kind TEXT, status TEXT");
  row = package.database().prepare(
      "INSERT INTO edges (geom, node_from, node_to, kind, status) VALUES (?, ?, ?, ?, ?)");
  const PoseGraph graph = map.graph();
  box.setEmpty();
  for (const PoseEdge& edge : graph.edges()) {
    const auto from = places.find(edge.from);
    const auto to = places.find(edge.to);
    if (from == places.end() || to == places.end()) {
      continue;
    }
    const std::array<Eigen::Vector3d, 2> ends{from->second, to->second};
    box.extend(Eigen::Vector2d(ends[0].head<2>())).extend(Eigen::Vector2d(ends[1].head<2>()));
    row.reset();
    row.bind(1, as_blob(package.line(ends))).bind(2, edge.from).bind(3, edge.to);
    row.bind(4, to_string(edge.kind)).bind(5, to_string(edge.status));
    row.step();
  }
  package.register_layer("edges", "LINESTRING", "edges of the pose graph; " + kHeights, box,
                         changed);
  package.finish();
  return path.sweeps.size();
}

}  // namespace adit
