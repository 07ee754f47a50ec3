// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_edits/control_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string_view>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/table_cells.hpp"

namespace adit {
namespace {

constexpr const char* kRemedy =
    "Expected a table with the columns name,role,x_m,y_m,z_m and latitude_deg,longitude_deg,"
    "altitude_m or easting_m,northing_m,height_m; docs/georeferencing.md has one";
constexpr std::array kInDegrees = {"latitude_deg", "longitude_deg", "altitude_m"};
constexpr std::array kInMetres = {"easting_m", "northing_m", "height_m"};
constexpr double kDoubtful = 3.29;  // standard deviations: 99.9 %

/// A table whose columns have names.
class ControlReader {
 public:
  ControlReader(const std::filesystem::path& file, const ProductSystem& system)
      : file_(file), system_(&system) {}

  std::vector<MarkedPoint> read() {
    const std::string text = read_text_file(file_);
    LineReader lines(text);
    std::vector<MarkedPoint> points;
    std::set<std::string> names;
    while (const auto line = lines.next()) {
      line_ = lines.number();
      const std::string_view content = trimmed_cell(without_comment(*line));
      if (content.empty()) {
        continue;
      }
      cells_ = cells_of(content);
      if (columns_.empty()) {
        take_head();
        continue;
      }
      if (cells_.size() != columns_.size()) {
        fail(fmt::format("the line has {} cells, the first line {}", cells_.size(),
                         columns_.size()));
      }
      points.push_back(point());
      if (!names.insert(points.back().point.name).second) {
        fail("the name " + in_quotes(points.back().point.name) + " is there twice");
      }
    }
    if (points.empty()) {
      throw InputError(file_, {}, "it has no points", kRemedy);
    }
    return points;
  }

 private:
  [[noreturn]] void fail(const std::string& found) const {
    throw InputError(file_, Place::line(line_), found, kRemedy);
  }

  bool has(std::string_view column) const {
    return std::ranges::find(columns_, column) != columns_.end();
  }

  void take_head() {
    columns_.assign(cells_.begin(), cells_.end());
    for (const char* column : {"name", "role", "x_m", "y_m", "z_m"}) {
      if (!has(column)) {
        fail(std::string("there is no column ") + column);
      }
    }
    const auto has_all = [&](const auto& names) {
      return std::ranges::all_of(names, [&](const char* name) { return has(name); });
    };
    in_metres_ = has_all(kInMetres);
    if (in_metres_ == has_all(kInDegrees)) {
      fail(in_metres_ ? "places are in degrees and in metres: leave one of the two out"
                      : "there are no columns for the points' places");
    }
    if (in_metres_ && !system_->zone && !system_->named) {
      throw InputError(file_, Place::line(line_), "places are in metres",
                       "Say of which system: --utm 32N, or --crs EPSG:25832");
    }
    if (!in_metres_ && (system_->zone || system_->named || system_->geoid)) {
      throw InputError(file_, Place::line(line_),
                       "places are in degrees, with heights above the ellipsoid",
                       "Leave --utm, --crs and --geoid out");
    }
  }

  std::string_view cell(std::string_view column) const {
    return cells_[static_cast<std::size_t>(std::ranges::find(columns_, column) - columns_.begin())];
  }

  double number(std::string_view column) const {
    const std::optional<double> value = parse_double(cell(column));
    if (!value || !std::isfinite(*value)) {
      fail(std::string(column) + " is " + in_quotes(cell(column)) + ", expected a number");
    }
    return *value;
  }

  Eigen::Vector3d vector(const std::array<const char*, 3>& columns) const {
    return {number(columns[0]), number(columns[1]), number(columns[2])};
  }

  Geodetic place() const {
    if (!in_metres_) {
      const Eigen::Vector3d at = vector(kInDegrees);
      if (std::abs(at.x()) > 90.0 || std::abs(at.y()) > 360.0) {
        fail("there is no such latitude and longitude");
      }
      return {.latitude = at.x(), .longitude = at.y(), .altitude = at.z()};
    }
    const Eigen::Vector3d at = vector(kInMetres);
    try {
      Geodetic place = system_->named ? system_->named->place_of(at.head<2>(), at.z())
                                      : place_of({.zone = system_->zone->zone,
                                                  .north = system_->zone->north,
                                                  .easting = at.x(),
                                                  .northing = at.y()},
                                                 at.z());
      if (system_->geoid) {
        place.altitude += system_->geoid->height_at(place);
      }
      return place;
    } catch (const NoSuchSystem& error) {
      fail(error.what());
    } catch (const std::invalid_argument& error) {
      fail(error.what());
    }
  }

  MarkedPoint point() const {
    MarkedPoint marked{.p_map = vector({"x_m", "y_m", "z_m"}), .line = line_};
    ControlPoint& point = marked.point;
    point.p_marked = marked.p_map;
    point.name = cell("name");
    if (point.name.empty()) {
      fail("the point has no name");
    }
    const std::string_view role = cell("role");
    if (role != "control" && role != "check") {
      fail("the role is " + in_quotes(role) + ", expected control or check");
    }
    point.role = role == "check" ? ControlRole::check : ControlRole::control;
    point.place = place();
    if (has("sigma_m")) {
      point.sigma.head<2>().setConstant(number("sigma_m"));
    }
    if (has("sigma_up_m")) {
      point.sigma.z() = number("sigma_up_m");
    }
    constexpr double kFinest = 1e-4;  // m
    constexpr double kCoarsest = 1e3;
    if (!(point.sigma.minCoeff() >= kFinest && point.sigma.maxCoeff() <= kCoarsest)) {
      fail("standard deviations must be between 0.0001 and 1000 m");
    }
    return marked;
  }

  std::filesystem::path file_;
  const ProductSystem* system_;
  std::size_t line_ = 0;
  std::vector<std::string> columns_;
  std::vector<std::string_view> cells_;
  bool in_metres_ = false;
};

/// Of the keyframes whose submaps reach to the mark, the nearest. A mark that the map has kept from
/// before it moved stays where it was made.
void tie_to_keyframe(MarkedPoint& marked, const MapDatabase& map,
                     const std::vector<MapKeyframe>& keyframes, const std::filesystem::path& file) {
  for (const ControlPoint& kept : map.control_points()) {
    if (kept.name == marked.point.name && kept.p_marked == marked.p_map) {
      marked.point.keyframe = kept.keyframe;
      marked.point.p_keyframe = kept.p_keyframe;
      return;
    }
  }
  const Eigen::Vector3d near = Eigen::Vector3d::Constant(0.5);  // m
  const std::vector<NodeId> reaching = map.submaps_within(marked.p_map - near, marked.p_map + near);
  const MapKeyframe* nearest = nullptr;
  double distance = INFINITY;
  for (const MapKeyframe& keyframe : keyframes) {
    const double away = (keyframe.T_map_keyframe.translation() - marked.p_map).norm();
    if (away < distance && std::ranges::find(reaching, keyframe.id) != reaching.end()) {
      distance = away;
      nearest = &keyframe;
    }
  }
  if (nearest == nullptr) {
    throw InputError(file, Place::line(marked.line),
                     fmt::format("the map has nothing at {:.3f}, {:.3f}, {:.3f}", marked.p_map.x(),
                                 marked.p_map.y(), marked.p_map.z()),
                     "x_m, y_m and z_m are where the point is in the map's frame, as `adit view` "
                     "shows it of what is clicked");
  }
  marked.point.keyframe = nearest->id;
  marked.point.p_keyframe = nearest->T_map_keyframe.inverse() * marked.p_map;
}

/// The map's graph tied to the world by GNSS alone.
PoseGraph without_control(const MapDatabase& map) {
  PoseGraph graph = map.graph();
  graph.clear_fixes();
  if (const std::optional<Georeference> world = map.georeference()) {
    const WorldFrame frame(world->origin);
    for (const MapFix& fix : map.fixes()) {
      if (fix.verdict == FixVerdict::used) {
        graph.add_fix(as_measured(fix, frame));
      }
    }
    for (const MapHeading& heading : map.headings()) {
      graph.add_heading(as_measured(heading, graph, frame));
    }
  }
  return graph;
}

std::string spread_text(const ControlTable& table, ControlRole role) {
  const std::optional<PlaceSpread> spread = spread_of(table, role);
  return spread ? fmt::format("level {:.3f} m, up {:.3f} m", spread->level, spread->up) : "";
}

}  // namespace

std::vector<MarkedPoint> read_control(const std::filesystem::path& file,
                                      const ProductSystem& system) {
  return ControlReader(file, system).read();
}

ControlTable control_table(const MapDatabase& map) {
  const std::optional<Georeference> world = map.georeference();
  ControlTable table;
  if (world) {
    table.points = map.control_points();
    table.errors = control_errors(table.points, map.graph(), WorldFrame(world->origin));
  }
  return table;
}

std::optional<PlaceSpread> spread_of(std::span<const Eigen::Vector3d> errors) {
  if (errors.empty()) {
    return std::nullopt;
  }
  PlaceSpread spread{.count = errors.size()};
  for (const Eigen::Vector3d& error : errors) {
    spread.level += error.head<2>().squaredNorm();
    spread.up += error.z() * error.z();
    spread.largest = std::max(spread.largest, error.norm());
  }
  spread.level = std::sqrt(spread.level / static_cast<double>(spread.count));
  spread.up = std::sqrt(spread.up / static_cast<double>(spread.count));
  return spread;
}

std::optional<PlaceSpread> spread_of(const ControlTable& table, ControlRole role) {
  std::vector<Eigen::Vector3d> errors;
  for (std::size_t i = 0; i < table.points.size(); ++i) {
    if (table.points[i].role == role) {
      errors.push_back(table.errors[i]);
    }
  }
  return spread_of(errors);
}

ControlAdjustment adjust_to_control(const MapDatabase& map, const std::filesystem::path& table,
                                    const ProductSystem& system,
                                    const std::function<bool(const OptimizationStep&)>& on_step) {
  std::vector<MarkedPoint> marked = read_control(table, system);
  const std::vector<MapKeyframe> keyframes = map.keyframes();
  ControlAdjustment adjustment;
  for (MarkedPoint& point : marked) {
    tie_to_keyframe(point, map, keyframes, table);
    adjustment.table.points.push_back(point.point);
  }
  const std::optional<Georeference> world = map.georeference();
  adjustment.was_placed = world.has_value();
  try {
    adjustment.found =
        adjust_to_control(without_control(map), world, adjustment.table.points, on_step);
  } catch (const ControlError& error) {
    throw InputError(table, {}, error.what(),
                     "Look at their marks and places: a mistake, two points exchanged, another "
                     "system or kind of height. Nothing was changed");
  }
  adjustment.before = adjustment.found.before;
  adjustment.table.errors = adjustment.found.after;
  return adjustment;
}

std::string describe(const ControlAdjustment& adjustment) {
  const ControlTable& now = adjustment.table;
  const ControlTable then{.points = now.points, .errors = adjustment.before};
  std::string text =
      adjustment.was_placed
          ? "control      the map had a place on the Earth before\n"
          : "control      the map had no place on the Earth: before is as the points place it\n";
  text += "             error east, north, up (m)     before\n";
  for (std::size_t i = 0; i < now.points.size(); ++i) {
    const ControlPoint& point = now.points[i];
    const Eigen::Vector3d& e = now.errors[i];
    const Eigen::Vector3d& b = then.errors[i];
    const bool odd = (e.cwiseAbs().cwiseQuotient(point.sigma)).maxCoeff() > kDoubtful;
    text += fmt::format("{:<7} {:>8.3f} {:>8.3f} {:>8.3f} {:>10.3f} {:>8.3f} {:>8.3f}  {}{}\n",
                        to_string(point.role), e.x(), e.y(), e.z(), b.x(), b.y(), b.z(), point.name,
                        odd && point.role == ControlRole::control
                            ? ": beyond what its standard deviation allows"
                            : "");
  }
  for (const ControlRole role : {ControlRole::control, ControlRole::check}) {
    if (const auto spread = spread_of(now, role)) {
      text += fmt::format("rms          of {} {} point{}: {}; before {}\n", spread->count,
                          to_string(role), spread->count == 1 ? "" : "s", spread_text(now, role),
                          spread_text(then, role));
    } else {
      text +=
          "rms          there are no check points: nothing independent says how good the map "
          "is\n";
    }
  }
  return text;
}

nlohmann::ordered_json to_json(const PlaceSpread& spread) {
  return {{"count", spread.count},
          {"horizontal_rmse_m", spread.level},
          {"vertical_rmse_m", spread.up},
          {"largest_m", spread.largest}};
}

nlohmann::ordered_json to_json(const ControlAdjustment& adjustment) {
  const ControlTable& now = adjustment.table;
  const ControlTable then{.points = now.points, .errors = adjustment.before};
  const auto numbers = [](const Eigen::Vector3d& v) { return std::array{v.x(), v.y(), v.z()}; };
  nlohmann::ordered_json json;
  json["was_placed"] = adjustment.was_placed;
  json["points"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < now.points.size(); ++i) {
    json["points"].push_back({{"name", now.points[i].name},
                              {"role", to_string(now.points[i].role)},
                              {"keyframe", now.points[i].keyframe},
                              {"error_m", numbers(now.errors[i])},
                              {"error_before_m", numbers(then.errors[i])},
                              {"sigma_m", numbers(now.points[i].sigma)}});
  }
  for (const ControlRole role : {ControlRole::control, ControlRole::check}) {
    nlohmann::ordered_json& of_role = json[std::string(to_string(role))];
    for (const auto& [name, table] : {std::pair("after", &now), std::pair("before", &then)}) {
      if (const auto spread = spread_of(*table, role)) {
        of_role[name] = to_json(*spread);
      }
    }
  }
  return json;
}

}  // namespace adit
