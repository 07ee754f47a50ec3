// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_products/trajectory_products.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>

#include <fmt/core.h>

#include "adit/slam/core/units.hpp"
#include "adit/tools/clouds/las_writer.hpp"
#include "adit/tools/map_database/map_records.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

/// Degrees with ten decimals are hundredths of a millimetre.
std::string geodetic_text(const Geodetic& place) {
  return fmt::format("{:.10f},{:.10f},{:.4f}", place.longitude, place.latitude, place.altitude);
}

/// Consecutive places of one part. A line that crosses the antimeridian is cut there, as RFC 7946
/// asks.
std::vector<std::vector<std::size_t>> lines_of(const MapPath& path,
                                               std::span<const PlaceOnEarth> places) {
  std::vector<std::vector<std::size_t>> lines;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i == 0 || std::ranges::binary_search(path.parts, i) ||
        path.sweeps[i].session != path.sweeps[i - 1].session ||
        std::abs(places[i].geodetic.longitude - places[i - 1].geodetic.longitude) > 180.0) {
      lines.emplace_back();
    }
    lines.back().push_back(i);
  }
  return lines;
}

std::vector<PlaceOnEarth> places_of(const MapPath& path, const ProductCoordinates& earth) {
  std::vector<PlaceOnEarth> places;
  places.reserve(path.sweeps.size());
  for (const MapSweep& sweep : path.sweeps) {
    places.push_back(earth.place(sweep.T_map_lidar.translation()));
  }
  return places;
}

bool all_unix_times(const MapPath& path) {
  return std::ranges::all_of(path.sweeps,
                             [](const MapSweep& sweep) { return is_unix_time(sweep.stamp); });
}

/// Keyframes that a sweep of the path belongs to.
std::vector<MapKeyframe> keyframes_of(const MapPath& path, const MapDatabase& map) {
  std::set<NodeId> wanted;
  for (const MapSweep& sweep : path.sweeps) {
    wanted.insert(sweep.keyframe);
  }
  std::vector<MapKeyframe> keyframes = map.keyframes();
  std::erase_if(keyframes,
                [&](const MapKeyframe& keyframe) { return !wanted.contains(keyframe.id); });
  return keyframes;
}

std::optional<NodeId> last_node_with_an_edge(const PoseGraph& graph) {
  std::optional<NodeId> last;
  for (const PoseEdge& edge : graph.edges()) {
    last = std::max({last.value_or(0), edge.from, edge.to});
  }
  return last;
}

/// The last keyframes of a run that has not ended have no edge yet, and are no parts.
bool is_waiting(const MapDatabase& map, const MapKeyframe& keyframe,
                const std::optional<NodeId>& last_with_an_edge) {
  return !(last_with_an_edge && keyframe.id <= *last_with_an_edge) &&
         !map.progress(keyframe.session).ending;
}

std::string xml_text(const std::string& text) {
  std::string escaped;
  for (const char letter : text) {
    escaped += letter == '&'   ? "&amp;"
               : letter == '<' ? "&lt;"
               : letter == '>' ? "&gt;"
                               : std::string(1, letter);
  }
  return escaped;
}

std::string placemark(const std::string& name, const std::string& geometry,
                      const std::string& content) {
  return fmt::format(
      "<Placemark>\n<name>{0}</name>\n<{1}>\n<altitudeMode>absolute</altitudeMode>\n{2}</{1}>\n"
      "</Placemark>\n",
      name, geometry, content);
}

}  // namespace

std::string iso_time(Nanoseconds unix_time) {
  using namespace std::chrono;
  const sys_time<Nanoseconds> time(unix_time);
  const auto date = floor<days>(time);
  const year_month_day parts(date);
  const int64_t ms = floor<milliseconds>(time - date).count();
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", static_cast<int>(parts.year()),
                     static_cast<unsigned>(parts.month()), static_cast<unsigned>(parts.day()),
                     ms / 3'600'000, ms / 60'000 % 60, ms / 1000 % 60, ms % 1000);
}

MapPath map_path(const MapDatabase& map, const CloudSelection& selection) {
  MapPath path;
  const PoseGraph graph = map.graph();
  const GraphComponents tied = connected_components(graph);
  const std::optional<NodeId> last_tied = last_node_with_an_edge(graph);
  std::optional<std::size_t> component;
  for (const MapKeyframe& keyframe : map.keyframes()) {
    const std::size_t before = path.sweeps.size();
    for (const SubmapSweep& sweep : load_sweeps(map, keyframe.id, map.file()).sweeps) {
      if (is_wanted(selection, keyframe.session, sweep.stamp)) {
        path.sweeps.push_back({.session = keyframe.session,
                               .keyframe = keyframe.id,
                               .stamp = sweep.stamp,
                               .T_map_lidar = keyframe.T_map_keyframe * sweep.T_keyframe_lidar,
                               .merged = sweep.merged});
      }
    }
    const std::size_t here = tied.component_of[graph.index_of(keyframe.id)];
    if (component && *component != here && before < path.sweeps.size() && before > 0 &&
        !is_waiting(map, keyframe, last_tied)) {
      path.parts.push_back(before);
    }
    if (before < path.sweeps.size()) {
      component = here;
    }
  }
  return path;
}

std::size_t write_trajectory_csv(const std::filesystem::path& file, const MapPath& path,
                                 const std::optional<ProductCoordinates>& earth) {
  OutputFile output(file);
  output.write("session,keyframe,stamp,x,y,z,qx,qy,qz,qw,merged");
  output.write(earth ? ",local_x_m,local_y_m,local_z_m,latitude_deg,longitude_deg,altitude_m,"
                       "utm_zone,easting_m,northing_m,convergence_deg,scale"
                     : "");
  const bool named = earth && earth->frame() == ProductFrame::named;
  output.write(named ? ",crs_east_m,crs_north_m" : "");
  output.write(earth && earth->has_geoid() ? ",orthometric_m\n" : "\n");
  for (const MapSweep& sweep : path.sweeps) {
    std::string line = std::to_string(sweep.session) + "," + std::to_string(sweep.keyframe) + ",";
    append_stamp(line, sweep.stamp);
    for (const double number : numbers_of(sweep.T_map_lidar)) {
      line += ',';
      append_number(line, number);
    }
    line += sweep.merged ? ",1" : ",0";
    if (earth) {
      const PlaceOnEarth place = earth->place(sweep.T_map_lidar.translation());
      line += fmt::format(
          ",{:.4f},{:.4f},{:.4f},{:.10f},{:.10f},{:.4f},{},{:.4f},{:.4f},{:.8f},{:.10f}",
          place.p_local.x(), place.p_local.y(), place.p_local.z(), place.geodetic.latitude,
          place.geodetic.longitude, place.geodetic.altitude, to_string(earth->zone()),
          place.utm.easting, place.utm.northing, place.utm.convergence * kDegreesPerRadian,
          place.utm.scale);
      if (named) {
        const Eigen::Vector3d p = earth->from_map(Eigen::Vector3d(sweep.T_map_lidar.translation()));
        line += fmt::format(",{:.4f},{:.4f}", p.x(), p.y());
      }
      if (const std::optional<double> height = earth->orthometric(place.geodetic)) {
        line += fmt::format(",{:.4f}", *height);
      }
    }
    output.write(line + "\n");
  }
  output.close();
  return path.sweeps.size();
}

std::size_t write_trajectory_geojson(const std::filesystem::path& file, const MapPath& path,
                                     const MapDatabase& map, const ProductCoordinates& earth) {
  const std::vector<PlaceOnEarth> places = places_of(path, earth);
  OutputFile output(file);
  output.write("{\"type\": \"FeatureCollection\", \"features\": [");
  std::string before = "\n";
  for (const std::vector<std::size_t>& line : lines_of(path, places)) {
    if (line.size() < 2) {
      continue;  // a line has two ends
    }
    std::string coordinates;
    for (const std::size_t i : line) {
      coordinates += (coordinates.empty() ? "[" : ", [") + geodetic_text(places[i].geodetic) + "]";
    }
    std::string first;
    std::string last;
    append_stamp(first, path.sweeps[line.front()].stamp);
    append_stamp(last, path.sweeps[line.back()].stamp);
    output.write(fmt::format(
        "{}{{\"type\": \"Feature\", \"geometry\": {{\"type\": \"LineString\", "
        "\"coordinates\": [{}]}}, \"properties\": {{\"session\": {}, "
        "\"sweeps\": {}, \"first_stamp_s\": {}, \"last_stamp_s\": {}}}}}",
        before, coordinates, path.sweeps[line.front()].session, line.size(), first, last));
    before = ",\n";
  }
  for (const MapKeyframe& keyframe : keyframes_of(path, map)) {
    const PlaceOnEarth place = earth.place(keyframe.T_map_keyframe.translation());
    std::string stamp;
    append_stamp(stamp, keyframe.stamp);
    output.write(
        fmt::format("{}{{\"type\": \"Feature\", \"geometry\": {{\"type\": \"Point\", "
                    "\"coordinates\": [{}]}}, \"properties\": {{\"session\": {}, "
                    "\"keyframe\": {}, \"stamp_s\": {}}}}}",
                    before, geodetic_text(place.geodetic), keyframe.session, keyframe.id, stamp));
    before = ",\n";
  }
  output.write("\n]}\n");
  output.close();
  return path.sweeps.size();
}

std::size_t write_trajectory_kml(const std::filesystem::path& file, const MapPath& path,
                                 const std::string& name, const ProductCoordinates& earth) {
  const std::vector<PlaceOnEarth> places = places_of(path, earth);
  const bool timed = all_unix_times(path);
  OutputFile output(file);
  output.write(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<kml xmlns=\"http://www.opengis.net/kml/2.2\" "
      "xmlns:gx=\"http://www.google.com/kml/ext/2.2\">\n<Document>\n<name>" +
      xml_text(name) + "</name>\n<description>" +
      (earth.has_geoid() ? "Heights are above the sea, by a geoid."
                         : "Heights are above the WGS 84 ellipsoid, where KML means the sea.") +
      std::string("</description>\n"));
  for (const std::vector<std::size_t>& line : lines_of(path, places)) {
    std::string coordinates;
    std::string when;
    std::string where;
    for (const std::size_t i : line) {
      Geodetic place = places[i].geodetic;
      place.altitude = earth.orthometric(place).value_or(place.altitude);
      coordinates += geodetic_text(place) + "\n";
      if (timed) {
        when += "<when>" + iso_time(path.sweeps[i].stamp) + "</when>\n";
        where += fmt::format("<gx:coord>{:.10f} {:.10f} {:.4f}</gx:coord>\n", place.longitude,
                             place.latitude, place.altitude);
      }
    }
    const SessionId session = path.sweeps[line.front()].session;
    output.write(placemark(fmt::format("session {}", session),
                           line.size() < 2 ? "Point" : "LineString",
                           "<coordinates>\n" + coordinates + "</coordinates>\n"));
    if (timed) {  // beside the line: GDAL's own driver of KML passes tracks over
      output.write(
          placemark(fmt::format("session {}, with times", session), "gx:Track", when + where));
    }
  }
  output.write("</Document>\n</kml>\n");
  output.close();
  return path.sweeps.size();
}

}  // namespace adit
