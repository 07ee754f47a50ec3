// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/export_elevation.hpp"

#include <array>

#include <fmt/core.h>

#include "adit/slam/core/text.hpp"
#include "adit/tools/export/export_contours.hpp"
#include "adit/tools/plans/elevation_map.hpp"
#include "adit/tools/plans/height_raster.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {

std::string export_elevation(const ExportJob& job) {
  const ProductCoordinates coordinates = coordinates_of(job, true);
  const GroundLevelsFound found = find_ground(job, coordinates);
  const double cell = job.options->cell.value_or(found.size);
  if (cell < found.size) {
    throw UsageError(fmt::format(
        "--elevation: the ground is known in cells of {} m. Choose a --cell that is no smaller.",
        shortest(found.size)));
  }
  // Of several storeys the one that is reached first, as in rasters.
  GroundLevels first;
  for (const auto& [index, heights] : found.levels) {
    first[index] = {heights.front()};
  }
  const GroundPlanes planes(first, found.size);
  ElevationMap map(planes, cell);
  visit_plan_points(*job.map, coordinates, selection_of(job, coordinates),
                    [&](const MapKeyframe&, std::span<const PlanPoint> points) {
                      map.add(points);
                      require_within(job);
                    });
  const ElevationLayers layers = map.layers();
  if (layers.elevation.cells().empty()) {
    throw UsageError("--elevation: no ground was seen in what is left of the map.");
  }
  const std::array<HeightBand, 6> bands = {
      HeightBand{.band = {"elevation", "m"}, .values = &layers.elevation},
      HeightBand{.band = {"variance", "m2"}, .values = &layers.variance},
      HeightBand{.band = {"slope", "degree"}, .values = &layers.slope},
      HeightBand{.band = {"roughness", "m"}, .values = &layers.roughness},
      HeightBand{.band = {"step_height", "m"}, .values = &layers.step_height},
      HeightBand{.band = {"obstacle_height", "m"}, .values = &layers.obstacle_height}};
  write_height_bands(job.file, bands, coordinates,
                     "elevation map: elevation, variance, slope, roughness, step_height, "
                     "obstacle_height");
  return fmt::format("{} cells of ground of {} m, 6 bands{}", layers.elevation.cells().size(),
                     shortest(cell), in_coordinates(coordinates));
}

}  // namespace adit
