// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/export_plan_options.hpp"

#include "adit/tools/support/usage_error.hpp"

namespace adit {

bool is_plan(const ExportCommandOptions& options) {
  return !options.slice.empty() || !options.section.empty() || options.plan ||
         options.contours.has_value() || options.elevation;
}

bool is_plan_raster(const ExportCommandOptions& options) {
  return is_plan(options) && options.output &&
         (options.output->extension() == ".tif" || options.output->extension() == ".tiff");
}

void check_plan_options(const ExportCommandOptions& options) {
  if (!is_plan(options)) {
    return;
  }
  const std::string end = options.output->extension().string();
  const std::string name = "-o " + options.output->string();
  if (options.elevation) {
    if (!is_plan_raster(options)) {
      throw UsageError(name + ": an elevation map is a GeoTIFF; name it *.tif.");
    }
    return;
  }
  if (options.contours) {
    if (end != ".dxf" && end != ".geojson" && end != ".gpkg") {
      throw UsageError(name +
                       ": contour lines are DXF, GeoJSON or GeoPackage files; name it *.dxf, "
                       "*.geojson or *.gpkg.");
    }
    return;
  }
  if (!options.section.empty() && is_plan_raster(options)) {
    throw UsageError(name +
                     ": a section is upright, and a GeoTIFF lies on the ground; name it "
                     "*.dxf or *.svg.");
  }
  if (end != ".dxf" && end != ".svg" && !is_plan_raster(options)) {
    throw UsageError(name +
                     ": plans are DXF, SVG or GeoTIFF files; name it *.dxf, *.svg or *.tif.");
  }
}

void add_plan_options(const Command& command, ExportCommandOptions& options) {
  command
      .option("--slice", options.slice,
              "A plan at this height in the product's frame (m): the points within THICKNESS (0.2 "
              "m) as lines and points, DXF, SVG or GeoTIFF by FILE's end")
      .value_name("HEIGHT[,THICKNESS]");
  command
      .option(
          "--section", options.section,
          "The same along an upright plane, from X0,Y0 to X1,Y1 of the product's frame (m): DXF "
          "or SVG")
      .value_name("X0,Y0,X1,Y1[,THICKNESS]");
  command.flag("--plan", options.plan,
               "A plan of each storey that the path leads over, 1.2 m above its floor: FILE_0, "
               "FILE_1 and so on, from the lowest");
  command
      .option("--contours", options.contours,
              "Contour lines of the ground, so many metres apart in height: DXF, GeoJSON or "
              "GeoPackage by FILE's end")
      .from(0.01, 1000.0)
      .value_name("STEP");
  command.flag("--elevation", options.elevation,
               "Elevation map for robots as GeoTIFF: height of the ground, its variance, slope, "
               "roughness, steps, and what stands on it");
}

}  // namespace adit
