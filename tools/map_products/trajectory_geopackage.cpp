// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "adit/tools/clouds/las_writer.hpp"
#include "adit/tools/map_products/geopackage.hpp"
#include "adit/tools/map_products/trajectory_products.hpp"

namespace adit {
namespace {

/// Where layers have it: in the coordinates' plane where they have one, else geodetic.
Eigen::Vector3d layer_place(const ProductCoordinates& earth, const Eigen::Vector3d& p_map) {
  if (earth.epsg()) {
    return earth.from_map(p_map);
  }
  const Geodetic geodetic = earth.place(p_map).geodetic;
  return {geodetic.longitude, geodetic.latitude, geodetic.altitude};
}

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
  const GeoPackage package(file, {.epsg = earth.epsg().value_or(kGeodeticSystem),
                                  .name = earth.plane_name(),
                                  .wkt = earth.plane_wkt()});
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
    const Eigen::Vector3d place = layer_place(earth, keyframe.T_map_keyframe.translation());
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
      line.push_back(layer_place(earth, path.sweeps[i].T_map_lidar.translation()));
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
