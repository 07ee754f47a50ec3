// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/export_contours.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "adit/slam/core/text.hpp"
#include "adit/tools/export/contour_files.hpp"
#include "adit/tools/plans/contour_lines.hpp"
#include "adit/tools/plans/plan_points.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

constexpr double kContourCell = 0.5;  // m: as close as contours are read
// m, of cells that ground is followed in: a step to the next one rises less than a chair's seat.
constexpr double kSearchCell = 0.25;

std::string contours_text(const std::vector<ContourLine>& lines, const GroundHeights& ground) {
  return fmt::format("{} lines from {} to {} m, of {} cells of ground of {} m", lines.size(),
                     in_digits(lines.front().height, 6), in_digits(lines.back().height, 6),
                     ground.cells().size(), shortest(ground.size()));
}

}  // namespace

GroundLevelsFound find_ground(const ExportJob& job, const ProductCoordinates& coordinates) {
  const CloudSelection selection = selection_of(job, coordinates);
  CloudSelection anywhere = selection;
  anywhere.polygon.clear();  // the ground of a part is reached from outside of it, too
  GroundSearch search(kSearchCell);
  std::vector<FloorStep> steps;
  visit_plan_points(*job.map, coordinates, anywhere,
                    [&](const MapKeyframe& keyframe, std::span<const PlanPoint> points) {
                      const Eigen::Vector3d sensor = coordinates.from_map(
                          Eigen::Vector3d(keyframe.T_map_keyframe.translation()));
                      if (is_wanted(selection, keyframe.session, keyframe.stamp)) {
                        steps.push_back(floor_step(keyframe, sensor, points));
                      }
                      search.add(points);
                      require_within(job);
                    });
  return {.levels = search.levels_from(floors_under(std::move(steps))), .size = kSearchCell};
}

GroundHeights ground_of(const ExportJob& job, const ProductCoordinates& coordinates, double size,
                        const std::string& option) {
  if (size < kSearchCell) {
    throw UsageError(option +
                     ": the ground is known in cells of 0.25 m. Choose a --cell that is no "
                     "smaller.");
  }
  const CloudSelection selection = selection_of(job, coordinates);
  const GroundLevelsFound found = find_ground(job, coordinates);
  const GroundHeights grid(found.size);
  GroundHeights ground(size);
  std::map<GroundHeights::Index, std::pair<double, double>> means;  // sum and number
  for (const auto& [cell, heights] : found.levels) {
    if (selection.polygon.empty() || is_within(selection.polygon, grid.middle(cell))) {
      auto& [sum, count] = means[ground.index_of(grid.middle(cell))];
      sum += heights.front();
      count += 1.0;
    }
  }
  for (const auto& [cell, mean] : means) {
    ground.set(cell, mean.first / mean.second);
  }
  if (ground.cells().empty()) {
    throw UsageError(option + ": no ground was seen in what is left of the map.");
  }
  return ground;
}

std::string export_contours(const ExportJob& job) {
  const ExportCommandOptions& options = *job.options;
  const double step = *options.contours;
  const ProductCoordinates coordinates = coordinates_of(job, true);
  const GroundHeights ground =
      smoothed(ground_of(job, coordinates, options.cell.value_or(kContourCell), "--contours"));
  const std::vector<ContourLine> lines = contour_lines(ground, step);
  if (lines.empty()) {
    throw UsageError(
        fmt::format("--contours {}: the ground reaches no multiple of it.", shortest(step)));
  }
  const std::string end = options.output->extension().string();
  const ContourSheet sheet{.lines = &lines, .step = step, .coordinates = &coordinates};
  if (end == ".gpkg") {
    write_contours_geopackage(job.file, sheet);
  } else if (end == ".dxf") {
    write_text_file(job.file, contours_dxf(sheet));
  } else {
    if (coordinates.frame() == ProductFrame::map) {
      throw UsageError("-o " + options.output->string() +
                       ": GeoJSON is in degrees (RFC 7946), and these contours are in the map's "
                       "own frame. Name it *.dxf or *.gpkg; or leave out --frame, and place a map "
                       "that is not georeferenced with --origin LAT,LON,ALT[,YAW].");
    }
    write_text_file(job.file, contours_geojson(sheet));
    return contours_text(lines, ground) + ", in degrees on WGS 84; heights of " +
           coordinates.name();
  }
  return contours_text(lines, ground) + in_coordinates(coordinates);
}

}  // namespace adit
