// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/export_raster.hpp"

#include <optional>

#include <fmt/core.h>

#include "adit/slam/core/text.hpp"
#include "adit/tools/export/cloud_painter.hpp"
#include "adit/tools/export/export_cloud.hpp"
#include "adit/tools/export/export_contours.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"
#include "adit/tools/map_products/cloud_raster.hpp"
#include "adit/tools/map_products/color_raster.hpp"
#include "adit/tools/map_products/occupancy_grid.hpp"
#include "adit/tools/map_products/surface_from_above.hpp"
#include "adit/tools/map_products/tiled_cloud.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/progress.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr double kRasterCell = 0.25;          // m
constexpr double kColorCell = 0.1;            // m: a few pixels of an image that is 10 m away
constexpr double kGridCell = 0.05;            // m
constexpr int64_t kMostPixels = 200'000'000;  // of a PNG, which is made in memory

/// A file beside the one that was asked for.
void write_beside(const fs::path& file, const std::string& text) {
  Draft draft(file);
  write_text_file(draft.path(), text);
  draft.take_its_place();
}

[[noreturn]] void fail_empty(const ExportCommandOptions& options) {
  throw UsageError("--raster " + options.raster +
                   ": no point is within what --box, --polygon, --session, --from and --until "
                   "leave of the map.");
}

/// A GeoTIFF, or a PNG with its world file. `raster`: a CloudRaster or a ColorRaster.
void write_raster(const ExportJob& job, const auto& raster, const ProductCoordinates& coordinates) {
  const fs::path& output = *job.options->output;
  if (output.extension() != ".png") {
    raster.write_tiff(job.file, coordinates);
    return;
  }
  const RasterFrame frame = raster.frame();
  if (frame.columns * frame.rows > kMostPixels) {
    throw UsageError(
        fmt::format("-o {}: a PNG of {} x {} pixels is too large. Choose larger cells "
                    "with --cell, or a GeoTIFF (*.tif).",
                    output.string(), frame.columns, frame.rows));
  }
  write_text_file(job.file, raster.png());
  write_beside(fs::path(output).replace_extension(".pgw"), world_file(frame));
}

std::string text_of(const auto& raster, const ProductCoordinates& coordinates) {
  const RasterFrame frame = raster.frame();
  return fmt::format("{} x {} cells of {} m, {} with {}{}", frame.columns, frame.rows,
                     shortest(frame.cell), raster.filled(), raster.kThings,
                     in_coordinates(coordinates));
}

}  // namespace

std::string export_raster(const ExportJob& job) {
  const ExportCommandOptions& options = *job.options;
  const ProductCoordinates coordinates = coordinates_of(job, true);
  const bool intensity = options.raster == "intensity";
  const bool ground = options.raster == "ground";
  const double cell = options.cell.value_or(kRasterCell);
  CloudRaster raster(intensity ? RasterValue::intensity
                     : ground  ? RasterValue::ground
                               : RasterValue::height,
                     cell);
  const TakeCloud take = [&](std::span<const CloudPoint> points) {
    raster.add(points);
    require_within(job);
  };
  if (intensity) {
    visit_dense(job, coordinates, selection_of(job, coordinates), take);
  } else if (ground) {
    const GroundHeights heights = ground_of(job, coordinates, cell, "--raster ground");
    for (const auto& [index, height] : heights.cells()) {
      const Eigen::Vector2d middle = heights.middle(index);
      const CloudPoint point{.position = {middle.x(), middle.y(), height}};
      take({&point, 1});
    }
  } else {
    visit_cloud(*job.map, coordinates, selection_of(job, coordinates), take);
  }
  if (raster.empty()) {
    fail_empty(options);
  }
  write_raster(job, raster, coordinates);
  return text_of(raster, coordinates);
}

std::string export_orthophoto(const ExportJob& job) {
  const ProductCoordinates coordinates = coordinates_of(job, true);
  const CloudSelection selection = selection_of(job, coordinates);
  CloudPainter painter(job);
  ColorRaster raster(job.options->cell.value_or(kColorCell));
  bool any = false;
  std::optional<Progress> progress;
  visit_surface_from_above(*job.map, coordinates, selection, raster.frame().cell,
                           job.memory->submap_bytes(),
                           [&](const SurfacePart& part, std::size_t done, std::size_t total) {
                             if (!progress) {
                               progress.emplace(*job.err, progress_style_of_stderr(), "export",
                                                total, Progress::Clock::now(), "tiles");
                             }
                             any = any || !part.points.empty();
                             painter.paint(part.points, part.middle);
                             raster.add(part.points);
                             progress->update(done, 0);
                             require_within(job);
                           });
  if (!any) {
    fail_empty(*job.options);
  }
  progress->finish();
  const std::string colored = painter.finish("surface");
  if (raster.empty()) {
    throw InputError(job.options->map, {}, "no camera saw the upper side of any surface",
                     "`adit export --cloud ply --colorize` shows what the cameras saw");
  }
  write_raster(job, raster, coordinates);
  return text_of(raster, coordinates) + colored;
}

std::string export_grid(const ExportJob& job) {
  const ExportCommandOptions& options = *job.options;
  const ProductCoordinates coordinates = coordinates_of(job, false);
  const CloudSelection selection = selection_of(job, coordinates);
  const double cell = options.cell.value_or(kGridCell);
  OccupancyGridConfig config{.cell = cell};
  if (!options.heights.empty()) {
    const auto heights = parse_number_list(options.heights);
    if (!heights || heights->size() != 2 || !((*heights)[0] < (*heights)[1])) {
      throw UsageError("--heights " + options.heights + ": expected LOW,HIGH with LOW < HIGH, m.");
    }
    config.low = (*heights)[0];
    config.high = (*heights)[1];
  }
  OccupancyGrid grid(config);
  for (const MapKeyframe& keyframe : job.map->keyframes()) {
    if (is_wanted(selection, keyframe.session, keyframe.stamp)) {
      grid.add(keyframe, load_submap(*job.map, keyframe.id, job.map->file()), coordinates,
               selection);
      require_within(job);
    }
  }
  if (grid.empty()) {
    throw UsageError(
        "--grid: no point is within what --session, --from and --until leave of the map.");
  }
  const fs::path picture = fs::path(*options.output).replace_extension(".pgm");
  Draft draft(picture);
  grid.write_pgm(draft.path());
  draft.take_its_place();
  write_text_file(job.file, grid.yaml(picture.filename().string()));
  return fmt::format("{} x {} cells of {} m{}", grid.columns(), grid.rows(), shortest(cell),
                     in_coordinates(coordinates));
}

}  // namespace adit
