// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/export_job.hpp"

#include <cmath>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/units.hpp"
#include "adit/tools/export/wanted_system.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

[[noreturn]] void fail_georeference(const std::string& wanted) {
  throw UsageError(wanted +
                   ": the map is not georeferenced. Place it by hand with --origin "
                   "LAT,LON,ALT[,YAW], by surveyed points with adit optimize --control, or map a "
                   "recording with GNSS.");
}

/// Formats that name a coordinate reference system by its number alone.
bool numbers_its_system(const ExportCommandOptions& options) {
  const std::string end = options.output ? options.output->extension().string() : "";
  return options.trajectory == "gpkg" || (options.contours && end == ".gpkg") ||
         options.elevation || (!options.raster.empty() && end != ".png") ||
         ((!options.slice.empty() || options.plan) && (end == ".tif" || end == ".tiff"));
}

ProductCoordinates coordinates_in(const ExportJob& job, ProductFrame frame) {
  const ExportCommandOptions& options = *job.options;
  const ProductSystem system = wanted_system(options.utm, options.crs, options.geoid);
  try {
    ProductCoordinates coordinates(*job.georeference, frame, system);
    if (frame == ProductFrame::named && !coordinates.epsg() && numbers_its_system(options)) {
      throw UsageError("--crs " + *options.crs +
                       ": it has no EPSG number, by which GeoTIFF and GeoPackage name systems.");
    }
    return coordinates;
  } catch (const NoSuchSystem& error) {
    throw UsageError("--crs " + *options.crs + ": " + error.what() + ".");
  } catch (const std::invalid_argument& error) {
    throw UsageError((options.utm ? "--utm " + *options.utm : std::string("the georeference")) +
                     ": it does not cover the map's place (" + error.what() + ").");
  }
}

std::vector<Eigen::Vector2d> box_of(const std::string& text) {
  const auto numbers = parse_number_list(text);
  if (!numbers || numbers->size() != 4 || !((*numbers)[0] < (*numbers)[2]) ||
      !((*numbers)[1] < (*numbers)[3])) {
    throw UsageError("--box " + text +
                     ": expected X0,Y0,X1,Y1 with X0 < X1 and Y0 < Y1, in the product's frame, m.");
  }
  const std::vector<double>& n = *numbers;
  return {{n[0], n[1]}, {n[2], n[1]}, {n[2], n[3]}, {n[0], n[3]}};
}

[[noreturn]] void fail_polygon(const std::filesystem::path& file, const Place& place,
                               const std::string& found) {
  throw InputError(file, place, found,
                   "A polygon is a GeoJSON Polygon, or a line \"x y\" a corner in the product's "
                   "frame (m), three or more");
}

/// The outer ring of the first polygon of a GeoJSON file.
std::vector<Eigen::Vector2d> polygon_of_geojson(const std::filesystem::path& file,
                                                const std::string& text, bool georeferenced,
                                                const ProductCoordinates& coordinates) {
  if (coordinates.frame() == ProductFrame::map) {
    const std::string in_degrees = "--polygon " + file.string() + " is in degrees";
    if (!georeferenced) {
      fail_georeference(in_degrees);
    }
    throw UsageError(in_degrees +
                     ", and the product in the map's own frame; say --frame utm or local, too.");
  }
  std::vector<Eigen::Vector2d> corners;
  try {
    nlohmann::json json = nlohmann::json::parse(text);
    if (json.contains("features")) {
      json = json.at("features").at(0);
    }
    if (json.contains("geometry")) {
      json = json.at("geometry");
    }
    if (json.at("type") != "Polygon") {
      fail_polygon(file, {}, "its first geometry is no Polygon");
    }
    for (const nlohmann::json& corner : json.at("coordinates").at(0)) {
      corners.emplace_back(coordinates
                               .from_geodetic({.latitude = corner.at(1).get<double>(),
                                               .longitude = corner.at(0).get<double>()})
                               .head<2>());
      if (!corners.back().allFinite()) {
        fail_polygon(file, {}, "a corner is nowhere on the Earth");
      }
    }
  } catch (const nlohmann::json::exception& error) {
    fail_polygon(file, {}, std::string("it is no GeoJSON: ") + error.what());
  } catch (const std::invalid_argument& error) {
    fail_polygon(file, {}, std::string("a corner is outside of the projection: ") + error.what());
  }
  return corners;
}

std::vector<Eigen::Vector2d> read_polygon(const std::filesystem::path& file, bool georeferenced,
                                          const ProductCoordinates& coordinates) {
  const std::string text = read_text_file(file);
  std::vector<Eigen::Vector2d> corners;
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string::npos && text[first] == '{') {
    corners = polygon_of_geojson(file, text, georeferenced, coordinates);
  } else {
    LineReader lines(text);
    while (const std::optional<std::string_view> line = lines.next()) {
      const std::vector<std::string_view> words = split_words(without_comment(*line));
      if (words.empty()) {
        continue;
      }
      const std::optional<double> x = parse_double(words[0]);
      const std::optional<double> y = words.size() == 2 ? parse_double(words[1]) : std::nullopt;
      if (!x || !y || !std::isfinite(*x) || !std::isfinite(*y)) {
        fail_polygon(file, Place::line(lines.number()), "it is no corner");
      }
      corners.emplace_back(*x, *y);
    }
  }
  if (corners.size() < 3) {
    fail_polygon(file, {}, fmt::format("it has {} corners", corners.size()));
  }
  return corners;
}

}  // namespace

std::optional<std::vector<double>> parse_number_list(std::string_view text) {
  std::vector<double> numbers;
  while (true) {
    const std::size_t comma = text.find(',');
    const std::optional<double> number = parse_double(text.substr(0, comma));
    if (!number) {
      return std::nullopt;
    }
    numbers.push_back(*number);
    if (comma == std::string_view::npos) {
      return numbers;
    }
    text.remove_prefix(comma + 1);
  }
}

Georeference parse_origin(const std::string& text) {
  const auto numbers = parse_number_list(text);
  if (!numbers || numbers->size() < 3 || numbers->size() > 4) {
    throw UsageError("--origin " + text +
                     ": expected LAT,LON,ALT or LAT,LON,ALT,YAW (degrees, degrees, m above the "
                     "ellipsoid, degrees counter-clockwise from east).");
  }
  Georeference placed;
  placed.origin = {
      .latitude = (*numbers)[0], .longitude = (*numbers)[1], .altitude = (*numbers)[2]};
  require_place("--origin " + text, placed.origin);
  if (numbers->size() == 4) {
    if (!std::isfinite((*numbers)[3])) {
      throw UsageError("--origin " + text +
                       ": its yaw is no direction; expected degrees counter-clockwise from east.");
    }
    placed.T_world_map = Eigen::AngleAxisd((*numbers)[3] * kDegree, Eigen::Vector3d::UnitZ());
  }
  return placed;
}

ProductCoordinates coordinates_of(const ExportJob& job, bool states_its_coordinates) {
  const std::string& wanted = job.options->frame;
  if (wanted == "geodetic") {
    throw UsageError(
        "--frame geodetic: degrees are for --trajectory csv, geojson, kml and gpkg alone.");
  }
  const ExportCommandOptions& options = *job.options;
  if (options.crs || (wanted.empty() && options.utm)) {
    if (!job.georeference) {
      fail_georeference(options.crs ? "--crs " + *options.crs : "--utm " + *options.utm);
    }
    return coordinates_in(job, options.crs ? ProductFrame::named : ProductFrame::utm);
  }
  if (wanted == "map" || (wanted.empty() && !(job.georeference && states_its_coordinates))) {
    if (options.origin || options.geoid) {
      throw UsageError((options.origin ? "--origin" : "--geoid") +
                       std::string(": what is asked for is in the map's own frame; say --frame ") +
                       (options.geoid ? "utm or --crs, too." : "local or utm, too."));
    }
    return {};
  }
  if (!job.georeference) {
    fail_georeference("--frame " + wanted);
  }
  return coordinates_in(job, wanted == "local" ? ProductFrame::local : ProductFrame::utm);
}

ProductCoordinates earth_of(const ExportJob& job, const std::string& format) {
  const ExportCommandOptions& options = *job.options;
  if (!job.georeference) {
    fail_georeference(!options.frame.empty() ? "--frame " + options.frame
                      : options.utm          ? "--utm " + *options.utm
                      : options.crs          ? "--crs " + *options.crs
                                             : "--trajectory " + format);
  }
  const bool utm = options.frame == "utm" || (options.frame.empty() && options.utm);
  return coordinates_in(job, options.crs ? ProductFrame::named
                             : utm       ? ProductFrame::utm
                                         : ProductFrame::local);
}

CloudSelection selection_of(const ExportJob& job, const ProductCoordinates& coordinates) {
  const ExportCommandOptions& options = *job.options;
  CloudSelection selection;
  selection.without_moving = options.without_moving;
  selection.moved = job.moved;
  if (job.gone) {
    selection.is_gone = [gone = job.gone](const Eigen::Vector3d& point, SessionId session) {
      return gone->has(point, session);
    };
  }
  for (const int64_t id : options.sessions) {
    if (!job.map->session(id)) {
      throw UsageError(
          fmt::format("--session {}: the map has no such session. `adit info` lists "
                      "them.",
                      id));
    }
    selection.sessions.insert(id);
  }
  if (options.from) {
    selection.from = nanoseconds(*options.from);
  }
  if (options.until) {
    selection.until = nanoseconds(*options.until);
  }
  if (!options.box.empty()) {
    selection.polygon = box_of(options.box);
  } else if (options.polygon) {
    selection.polygon = read_polygon(*options.polygon, job.georeference.has_value(), coordinates);
  }
  return selection;
}

void require_within(const ExportJob& job) {
  if (job.memory->exceeded()) {
    throw OutputError(*job.options->output,
                      job.options->output->string() + ": not completed: " + job.memory->text() +
                          ". Allow more, or choose a coarser --resolution or --cell.");
  }
}

std::string in_coordinates(const ProductCoordinates& coordinates) {
  return coordinates.frame() == ProductFrame::map ? "" : ", in " + coordinates.name();
}

}  // namespace adit
