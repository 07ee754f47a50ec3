// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/export_plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "adit/slam/core/text.hpp"
#include "adit/tools/map_products/cloud_raster.hpp"
#include "adit/tools/plans/plan_drawing.hpp"
#include "adit/tools/plans/plan_points.hpp"
#include "adit/tools/plans/storeys.hpp"
#include "adit/tools/plans/wall_lines.hpp"
#include "adit/tools/results/kept_inputs.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr double kSliceThickness = 0.2;  // m
constexpr double kSliceCell = 0.05;      // m, of rasters: as grids have
// m above a storey's floor: over tables and sills, below lintels.
constexpr double kPlanHeight = 1.2;

/// What --slice or --section ask for.
struct WantedCut {
  CutPlane plane{};
  std::string title{};
};

double thickness_of(const std::string& option, const std::vector<double>& numbers, std::size_t at) {
  const double thickness = numbers.size() > at ? numbers[at] : kSliceThickness;
  if (!(thickness > 0.0 && thickness <= 100.0)) {
    throw UsageError(option + ": a slice is more than 0 m thick, and 100 m at most.");
  }
  return thickness;
}

/// Finite numbers; nothing where they are no such list.
std::optional<std::vector<double>> finite_numbers(const std::string& text) {
  auto numbers = parse_number_list(text);
  if (numbers && !std::ranges::all_of(*numbers, [](double n) { return std::isfinite(n); })) {
    return std::nullopt;
  }
  return numbers;
}

WantedCut wanted_slice(const std::string& text) {
  const std::string option = "--slice " + text;
  const auto numbers = finite_numbers(text);
  if (!numbers || numbers->empty() || numbers->size() > 2) {
    throw UsageError(option + ": expected HEIGHT or HEIGHT,THICKNESS, in the product's frame, m.");
  }
  return {.plane = level_cut((*numbers)[0], thickness_of(option, *numbers, 1)),
          .title = fmt::format("Plan at {} m", shortest((*numbers)[0]))};
}

WantedCut wanted_section(const std::string& text) {
  const std::string option = "--section " + text;
  const auto numbers = finite_numbers(text);
  if (!numbers || numbers->size() < 4 || numbers->size() > 5) {
    throw UsageError(option +
                     ": expected X0,Y0,X1,Y1 or X0,Y0,X1,Y1,THICKNESS, in the product's frame, m.");
  }
  const std::vector<double>& n = *numbers;
  const Eigen::Vector2d from(n[0], n[1]);
  const Eigen::Vector2d to(n[2], n[3]);
  if (!((to - from).norm() > 0.0)) {
    throw UsageError(option + ": both ends are at one place.");
  }
  return {.plane = upright_cut(from, to, thickness_of(option, n, 4)),
          .title = fmt::format("Section from {}, {} to {}, {} m", shortest(n[0]), shortest(n[1]),
                               shortest(n[2]), shortest(n[3]))};
}

/// Heights of all points, for the message where a slice is empty.
struct HeightRange {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void extend(std::span<const PlanPoint> points) {
    for (const PlanPoint& point : points) {
      low = std::min(low, point.position.z());
      high = std::max(high, point.position.z());
    }
  }
};

/// Points of a slice on their way into the file that was asked for.
class SliceFile {
 public:
  SliceFile(const ExportJob& job, bool raster)
      : job_(&job),
        raster_(RasterValue::points, job.options->cell.value_or(kSliceCell)),
        wants_raster_(raster) {}

  void add(const CutPoint& point) {
    if (wants_raster_) {
      const CloudPoint of_raster{.position = {point.place.x(), point.place.y(), 0.0}};
      raster_.add({&of_raster, 1});
    } else {
      cells_.add(point.place, point.normal);
    }
  }
  bool empty() const { return raster_.empty() && cells_.empty(); }

  /// Writes it, and says what it is.
  std::string write(const fs::path& file, PlanSheet sheet, const ProductCoordinates& coordinates) {
    if (wants_raster_) {
      raster_.write_tiff(file, coordinates);
      return fmt::format("{} x {} cells of {} m, {} with points", raster_.columns(), raster_.rows(),
                         shortest(job_->options->cell.value_or(kSliceCell)), raster_.filled());
    }
    sheet.lines = find_walls(cells_);
    write_text_file(
        file, job_->options->output->extension() == ".dxf" ? plan_dxf(sheet) : plan_svg(sheet));
    double length = 0.0;
    for (const WallSegment& wall : sheet.lines.walls) {
      length += (wall.to - wall.from).norm();
    }
    return fmt::format("{} lines, {:.1f} m; {} cells of other points; noise {:.0f} mm",
                       sheet.lines.walls.size(), length, sheet.lines.rest.size(),
                       1e3 * sheet.lines.noise);
  }

 private:
  const ExportJob* job_;
  CloudRaster raster_;
  SliceCells cells_;
  bool wants_raster_;
};

bool is_raster(const ExportCommandOptions& options) {
  return options.output->extension() == ".tif" || options.output->extension() == ".tiff";
}

PlanSheet sheet_of(const ProductCoordinates& coordinates, std::string title, bool level) {
  const bool on_earth = coordinates.frame() != ProductFrame::map;
  return {.title = std::move(title),
          .coordinates = on_earth ? coordinates.name() : "",
          .north_up = on_earth && level};
}

}  // namespace

std::string export_slice(const ExportJob& job) {
  const ExportCommandOptions& options = *job.options;
  const bool level = !options.slice.empty();
  const WantedCut wanted = level ? wanted_slice(options.slice) : wanted_section(options.section);
  const ProductCoordinates coordinates = coordinates_of(job, true);
  SliceFile slice(job, is_raster(options));
  HeightRange heights;
  visit_plan_points(*job.map, coordinates, selection_of(job, coordinates),
                    [&](const MapKeyframe&, std::span<const PlanPoint> points) {
                      heights.extend(points);
                      for (const PlanPoint& point : points) {
                        if (const auto in_slice = cut(wanted.plane, point)) {
                          slice.add(*in_slice);
                        }
                      }
                      require_within(job);
                    });
  if (slice.empty()) {
    throw UsageError(level ? "--slice " + options.slice + ": no points at that height; " +
                                 (heights.low > heights.high
                                      ? std::string("no point is wanted at all.")
                                      : fmt::format("the points are from {:.2f} to {:.2f} m.",
                                                    heights.low, heights.high))
                           : "--section " + options.section + ": no points along that line.");
  }
  return slice.write(job.file, sheet_of(coordinates, wanted.title, level), coordinates) +
         in_coordinates(coordinates);
}

fs::path file_of_storey(const fs::path& file, std::size_t storey) {
  fs::path name = file.stem();
  name += "_" + std::to_string(storey);
  name += file.extension();
  return file.parent_path() / name;
}

std::string export_plan(const ExportJob& job) {
  const ExportCommandOptions& options = *job.options;
  const ProductCoordinates coordinates = coordinates_of(job, true);
  const CloudSelection selection = selection_of(job, coordinates);
  CloudSelection of_floors = selection;
  of_floors.polygon.clear();
  std::vector<FloorStep> steps;
  visit_plan_points(*job.map, coordinates, of_floors,
                    [&](const MapKeyframe& keyframe, std::span<const PlanPoint> points) {
                      const Eigen::Vector3d sensor = coordinates.from_map(
                          Eigen::Vector3d(keyframe.T_map_keyframe.translation()));
                      if (is_wanted(selection, keyframe.session, keyframe.stamp)) {
                        steps.push_back(floor_step(keyframe, sensor, points));
                      }
                    });
  const std::vector<Storey> storeys = find_storeys(floors_under(std::move(steps)));
  if (storeys.empty()) {
    throw UsageError(
        "--plan: the path keeps to no floor for 5 m. Choose a height yourself with --slice.");
  }
  for (std::size_t i = 0; i < storeys.size(); ++i) {
    for (const auto& input : {std::optional(options.map), options.polygon}) {
      keep_input("-o", file_of_storey(*options.output, i), input.value_or(fs::path()));
    }
  }
  std::vector<StoreyFloor> floors;
  std::vector<SliceFile> slices;
  for (const Storey& storey : storeys) {
    floors.emplace_back(storey.path);
    slices.emplace_back(job, is_raster(options));
  }
  const CutPlane plane = level_cut(kPlanHeight, kSliceThickness);
  visit_plan_points(*job.map, coordinates, selection,
                    [&](const MapKeyframe&, std::span<const PlanPoint> points) {
                      for (PlanPoint point : points) {
                        const double height = point.position.z();
                        for (std::size_t i = 0; i < floors.size(); ++i) {
                          point.position.z() = height - floors[i].at(point.position.head<2>());
                          if (const auto in_slice = cut(plane, point)) {
                            slices[i].add(*in_slice);
                          }
                        }
                      }
                      require_within(job);
                    });
  if (std::ranges::all_of(slices, &SliceFile::empty)) {
    throw UsageError("--plan: no points " + shortest(kPlanHeight) +
                     " m above any floor. Choose a height yourself with --slice.");
  }
  std::string wrote;
  for (std::size_t i = 0; i < storeys.size(); ++i) {
    const fs::path file = file_of_storey(*options.output, i);
    const std::string where =
        fmt::format("floor at {:.2f} m, {:.0f} m of path", storeys[i].floor, storeys[i].length);
    if (slices[i].empty()) {
      wrote += fmt::format("no     {} ({}: no points {} m above it)\n", file.string(), where,
                           shortest(kPlanHeight));
      continue;
    }
    Draft draft(file);
    const std::string title = fmt::format("Storey {}, {} m above the floor at {:.2f} m", i,
                                          shortest(kPlanHeight), storeys[i].floor);
    const std::string what =
        slices[i].write(draft.path(), sheet_of(coordinates, title, true), coordinates);
    draft.take_its_place();
    wrote += fmt::format("wrote  {} ({}; {}{})\n", file.string(), where, what,
                         in_coordinates(coordinates));
  }
  return wrote;
}

}  // namespace adit
