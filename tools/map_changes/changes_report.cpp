// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_changes/changes_report.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/units.hpp"
#include "adit/tools/clouds/las_writer.hpp"
#include "adit/tools/map_products/trajectory_products.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

using Json = nlohmann::ordered_json;

const char* name_of(ChangeOfSpace change) {
  return change == ChangeOfSpace::gone ? "gone" : "new";
}

/// "2026-01-31 12:00", or seconds where stamps do not count from 1970.
std::string date_of(Nanoseconds stamp) {
  if (!is_unix_time(stamp)) {
    return fmt::format("{:.0f} s", std::chrono::duration<double>(stamp).count());
  }
  std::string date = iso_time(stamp).substr(0, 16);
  std::ranges::replace(date, 'T', ' ');
  return date;
}

const ComparedSession& session_in(const ChangesOutcome& outcome, uint32_t period) {
  return *std::ranges::find(outcome.sessions, period, &ComparedSession::period);
}

/// Number of the session among those that are compared, from 1, by which tables name it.
std::size_t number_of(const ChangesOutcome& outcome, uint32_t period) {
  return static_cast<std::size_t>(&session_in(outcome, period) - outcome.sessions.data()) + 1;
}

double yaw_of(const UprightBox& box) {
  return std::atan2(box.along.y(), box.along.x()) * kDegreesPerRadian;
}

std::string sessions_table(const ChangesOutcome& outcome) {
  std::string text = "session  keyframes  first keyframe    from\n";
  for (std::size_t i = 0; i < outcome.sessions.size(); ++i) {
    const ComparedSession& session = outcome.sessions[i];
    text += fmt::format("{:7}  {:9}  {:16}  {} ({})\n", i + 1, session.keyframes,
                        date_of(session.first), session.map.string(), session.name);
  }
  return text;
}

std::string objects_table(const ChangesOutcome& outcome) {
  std::string text =
      "change  centre (m)                 size (m)             volume  points  seen through by\n";
  for (const ChangedObject& object : outcome.objects) {
    const Eigen::Vector3d& c = object.box.centre;
    const Eigen::Vector3d& s = object.box.size;
    text += fmt::format(
        "{:6}  {:25}  {:19}  {:6.2f}  {:6}  {} {} of session {}\n", name_of(object.change),
        fmt::format("{:.2f} {:.2f} {:.2f}", c.x(), c.y(), c.z()),
        fmt::format("{:.2f} x {:.2f} x {:.2f}", s.x(), s.y(), s.z()), object.box.volume(),
        object.points, object.through, object.through == 1 ? "submap" : "submaps",
        number_of(outcome, object.other));
  }
  return text;
}

Json numbers(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json degrees(const Geodetic& place) {
  const auto rounded = [](double value, double steps) { return std::round(value * steps) / steps; };
  return {rounded(place.longitude, 1e10), rounded(place.latitude, 1e10),
          rounded(place.altitude, 1e4)};
}

/// What a table, the JSON report and the GeoJSON file know of an object.
Json properties(const ChangesOutcome& outcome, const ChangedObject& object) {
  return {{"change", name_of(object.change)},
          {"session", number_of(outcome, object.period)},
          {"seen_through_in", number_of(outcome, object.other)},
          {"centre_m", numbers(object.box.centre)},
          {"size_m", numbers(object.box.size)},
          {"yaw_deg", yaw_of(object.box)},
          {"volume_m3", object.box.volume()},
          {"points", object.points},
          {"voxels", object.voxels},
          {"submaps_through", object.through}};
}

}  // namespace

std::string describe_changes(const ChangesCommandOptions& options, const ChangesOutcome& outcome) {
  std::string text = sessions_table(outcome);
  std::size_t changed = 0;
  for (const ChangedObject& object : outcome.objects) {
    changed += object.points;
  }
  text += outcome.objects.empty() ? "" : objects_table(outcome);
  const auto gone =
      std::ranges::count(outcome.objects, ChangeOfSpace::gone, &ChangedObject::change);
  text += fmt::format("changed   {} gone, {} new; {} of {} points\n", gone,
                      static_cast<std::ptrdiff_t>(outcome.objects.size()) - gone, changed,
                      outcome.points);
  if (!options.output.empty()) {
    text += fmt::format("wrote     {}, in {}\n", options.output.string(),
                        outcome.georeferenced
                            ? "degrees on WGS 84"
                            : "metres of the map's frame: the map has no geographic position");
  }
  return text;
}

std::string to_json(const ChangesCommandOptions& options, const ChangesOutcome& outcome) {
  Json json = {{"schema", "changes/1"},
               {"output", options.output.empty() ? Json() : Json(options.output.string())},
               {"georeferenced", outcome.georeferenced},
               {"voxel_m", outcome.voxel},
               {"points", outcome.points}};
  json["sessions"] = Json::array();
  for (std::size_t i = 0; i < outcome.sessions.size(); ++i) {
    const ComparedSession& session = outcome.sessions[i];
    json["sessions"].push_back({{"number", i + 1},
                                {"id", session.id},
                                {"name", session.name},
                                {"map", session.map.string()},
                                {"keyframes", session.keyframes},
                                {"first_stamp_ns", session.first.count()},
                                {"last_stamp_ns", session.last.count()}});
  }
  json["changes"] = Json::array();
  for (const ChangedObject& object : outcome.objects) {
    Json one = properties(outcome, object);
    one["place"] = object.place ? degrees(*object.place) : Json();
    json["changes"].push_back(std::move(one));
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_changes_geojson(const std::filesystem::path& file, const ChangesOutcome& outcome) {
  Json collection = {{"type", "FeatureCollection"}};
  if (!outcome.georeferenced) {
    collection["coordinates"] = "metres of the map's frame, which has no geographic position";
  }
  collection["features"] = Json::array();
  for (const ChangedObject& object : outcome.objects) {
    Json ring = Json::array();
    const double bottom = object.box.centre.z() - 0.5 * object.box.size.z();
    for (std::size_t i = 0; i < 5; ++i) {
      const Eigen::Vector2d corner = object.box.footprint()[i % 4];
      ring.push_back(outcome.georeferenced ? degrees(object.footprint[i % 4])
                                           : Json({corner.x(), corner.y(), bottom}));
    }
    collection["features"].push_back(
        {{"type", "Feature"},
         {"geometry", {{"type", "Polygon"}, {"coordinates", Json::array({std::move(ring)})}}},
         {"properties", properties(outcome, object)}});
  }
  write_text_file(file, collection.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace adit
