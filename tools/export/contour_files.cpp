// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/contour_files.hpp"

#include <cmath>

#include <fmt/core.h>

#include "adit/slam/core/text.hpp"
#include "adit/tools/drawing/dxf_drawing.hpp"
#include "adit/tools/map_products/geopackage.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

constexpr int64_t kIndexContour = 5;  // each fifth is an index contour

bool is_index(const ContourSheet& sheet, const ContourLine& line) {
  return std::llround(line.height / sheet.step) % kIndexContour == 0;
}

/// The inverse of from_map(): that is a rotation and a shift but for what projections stretch,
/// which is less than 0.1 %, so each step leaves a thousandth of the error.
Eigen::Vector3d in_map(const ProductCoordinates& coordinates, const Eigen::Vector3d& product) {
  constexpr int kSteps = 5;
  Eigen::Vector3d p_map = Eigen::Vector3d::Zero();
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Isometry3d T_map_here = Eigen::Isometry3d::Identity();
    T_map_here.translation() = p_map;
    const Eigen::Isometry3d T_product_here = coordinates.from_map(T_map_here);
    p_map += T_product_here.linear().transpose() * (product - T_product_here.translation());
  }
  return p_map;
}

/// The corners of a line; of a closed one the first again at the end.
std::vector<Eigen::Vector3d> corners_of(const ContourLine& line) {
  std::vector<Eigen::Vector3d> corners;
  for (const Eigen::Vector2d& place : line.places) {
    corners.emplace_back(place.x(), place.y(), line.height);
  }
  if (line.closed) {
    corners.push_back(corners.front());
  }
  return corners;
}

/// m, without the rounding of a multiple.
std::string height_text(const ContourLine& line) {
  return shortest(std::round(line.height * 1e6) / 1e6);
}

}  // namespace

std::string contours_dxf(const ContourSheet& sheet) {
  const ProductCoordinates& coordinates = *sheet.coordinates;
  const std::string in =
      coordinates.frame() == ProductFrame::map ? "" : ", in " + coordinates.name();
  DxfDrawing drawing({{.name = "CONTOURS", .color = 8}, {.name = "INDEX_CONTOURS", .color = 7}},
                     fmt::format("adit {}: contour lines each {} m{}; metres", version(),
                                 shortest(sheet.step), in));
  for (const ContourLine& line : *sheet.lines) {
    drawing.polyline(is_index(sheet, line) ? "INDEX_CONTOURS" : "CONTOURS", line.places,
                     line.closed, line.height);
  }
  return drawing.str();
}

std::string contours_geojson(const ContourSheet& sheet) {
  std::string text = "{\"type\": \"FeatureCollection\", \"features\": [";
  const char* before = "\n";
  for (const ContourLine& line : *sheet.lines) {
    std::string corners;
    for (const Eigen::Vector3d& corner : corners_of(line)) {
      const Geodetic place = sheet.coordinates->place(in_map(*sheet.coordinates, corner)).geodetic;
      corners += fmt::format("{}[{}, {}]", corners.empty() ? "" : ", ",
                             with_decimals(place.longitude, 9), with_decimals(place.latitude, 9));
    }
    text += fmt::format(
        "{}{{\"type\": \"Feature\", \"geometry\": {{\"type\": \"LineString\", \"coordinates\": "
        "[{}]}}, \"properties\": {{\"height_m\": {}, \"index\": {}, \"closed\": {}}}}}",
        before, corners, height_text(line), is_index(sheet, line), line.closed);
    before = ",\n";
  }
  return text + "\n]}\n";
}

void write_contours_geopackage(const std::filesystem::path& file, const ContourSheet& sheet) {
  const ProductCoordinates& coordinates = *sheet.coordinates;
  const GeoPackage package(file, {.epsg = coordinates.epsg().value_or(kUndefinedPlane),
                                  .name = coordinates.plane_name(),
                                  .wkt = coordinates.plane_wkt()});
  package.create_layer("contours", "height_m DOUBLE, is_index BOOLEAN, closed BOOLEAN");
  SqliteStatement row = package.database().prepare(
      "INSERT INTO contours (geom, height_m, is_index, closed) VALUES (?, ?, ?, ?)");
  Eigen::AlignedBox2d box;
  for (const ContourLine& line : *sheet.lines) {
    const std::vector<Eigen::Vector3d> corners = corners_of(line);
    for (const Eigen::Vector3d& corner : corners) {
      box.extend(Eigen::Vector2d(corner.head<2>()));
    }
    const std::string geometry = package.line(corners);
    row.reset();
    row.bind(1, as_blob(geometry)).bind(2, line.height);
    row.bind(3, int64_t{is_index(sheet, line)}).bind(4, int64_t{line.closed}).step();
  }
  // The time of the change is fixed: same map, same bytes.
  package.register_layer("contours", "LINESTRING",
                         "contour lines of the ground; " + coordinates.name(), box,
                         "1970-01-01T00:00:00.000Z");
  package.finish();
}

}  // namespace adit
