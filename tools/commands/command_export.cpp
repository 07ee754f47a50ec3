// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_export.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/shared_options.hpp"
#include "adit/tools/commands/export_class_options.hpp"
#include "adit/tools/commands/export_color_options.hpp"
#include "adit/tools/commands/export_plan_options.hpp"
#include "adit/tools/export/export_cloud.hpp"
#include "adit/tools/export/export_contours.hpp"
#include "adit/tools/export/export_elevation.hpp"
#include "adit/tools/export/export_job.hpp"
#include "adit/tools/export/export_plan.hpp"
#include "adit/tools/export/export_poses.hpp"
#include "adit/tools/export/export_raster.hpp"
#include "adit/tools/export/export_report.hpp"
#include "adit/tools/export/found_space.hpp"
#include "adit/tools/map_database/map_location.hpp"
#include "adit/tools/results/kept_inputs.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

// What an export needs besides the program: the voxels of a tile, a submap, a sweep.
constexpr uint64_t kWorkingBytes = uint64_t{96} << 20U;

bool is_picture(const fs::path& file) {
  return file.extension() == ".svg" || file.extension() == ".png";
}

void check_heights(const ExportCommandOptions& options) {
  if (options.geoid && options.trajectory == "geojson") {
    throw UsageError("--geoid: heights of GeoJSON are above the ellipsoid (RFC 7946).");
  }
  if (options.geoid && options.trajectory == "gpkg" && options.frame != "utm" && !options.utm &&
      !options.crs) {
    throw UsageError(
        "--geoid: --trajectory gpkg in degrees has heights above the ellipsoid; say "
        "--frame utm or --crs, too.");
  }
  if (options.geoid && !options.frame.empty() && options.frame != "utm" &&
      options.frame != "geodetic") {
    throw UsageError("--geoid and --frame " + options.frame +
                     " exclude each other: heights there are the map's own.");
  }
}

void check_frames(const ExportCommandOptions& options) {
  const bool on_earth = options.trajectory == "csv" || options.trajectory == "geojson" ||
                        options.trajectory == "kml" || options.trajectory == "gpkg";
  const std::string placed = !options.frame.empty() ? "--frame"
                             : options.utm          ? "--utm"
                             : options.crs          ? "--crs"
                             : options.geoid        ? "--geoid"
                             : options.origin       ? "--origin"
                                                    : "";
  if (!placed.empty() && (options.picture || options.dump)) {
    throw UsageError(placed + ": pictures and dumps are in the map's frame.");
  }
  if ((options.utm || options.crs) &&
      (options.trajectory == "geojson" || options.trajectory == "kml")) {
    throw UsageError((options.utm ? "--utm" : "--crs") + std::string(": --trajectory ") +
                     options.trajectory + " is geodetic.");
  }
  if (options.crs && (options.utm || !options.frame.empty())) {
    throw UsageError("--crs and " + std::string(options.utm ? "--utm" : "--frame") +
                     " exclude each other.");
  }
  check_heights(options);
  if (options.report && options.frame == "map") {
    throw UsageError("--frame map: a report says where the map lies, in utm or local.");
  }
  if (on_earth && options.trajectory != "gpkg" && !options.frame.empty() &&
      options.frame != "geodetic") {
    throw UsageError(
        "--frame " + options.frame + ": --trajectory " + options.trajectory +
        (options.trajectory == "csv" ? " has the places of all frames." : " is geodetic."));
  }
  if (options.trajectory == "gpkg" && (options.frame == "map" || options.frame == "local")) {
    throw UsageError("--frame " + options.frame + ": --trajectory gpkg is geodetic or utm.");
  }
  if (options.utm && options.frame != "utm" && !options.frame.empty()) {
    throw UsageError("--utm and --frame " + options.frame + " exclude each other.");
  }
}

void check_selection(const ExportCommandOptions& options) {
  const bool points = !options.cloud.empty() || !options.dense.empty() || options.tiles ||
                      !options.raster.empty() || is_plan(options);
  if (!options.box.empty() && options.polygon) {
    throw UsageError("--box and --polygon exclude each other.");
  }
  if ((!options.box.empty() || options.polygon || options.without_moving) && !points) {
    throw UsageError(
        "--box, --polygon and --without-moving are for points: --cloud, --dense, "
        "--tiles, --raster, plans.");
  }
  if (options.find_moving && !points && !options.grid && !options.report) {
    throw UsageError(
        "--find-moving is for points, grids and reports: --cloud, --dense, --tiles, --raster, "
        "plans, --grid, --report.");
  }
  if (options.without_gone && !points) {
    throw UsageError("--without-gone is for points: --cloud, --dense, --tiles, --raster, plans.");
  }
  const bool finds_moving = options.find_moving || !options.clean.empty();
  if (!finds_moving && !options.color &&
      (!options.device.device.empty() || options.device.validation ||
       options.device.max_vram_bytes > 0)) {
    throw UsageError(
        "--device, --max-vram and --validation need --find-moving, --clean, --colorize or "
        "--raster color.");
  }
  if (options.without_moving && (!options.raster.empty() || is_plan(options))) {
    throw UsageError("--without-moving: rasters and plans leave out what moves anyway.");
  }
  if (options.without_moving && !options.dense.empty() && !finds_moving) {
    throw UsageError(
        "--without-moving: of single returns it is not known, unless --find-moving looks for it.");
  }
  if (options.from && options.until && *options.from > *options.until) {
    throw UsageError("--from is later than --until: nothing is between them.");
  }
  if ((!options.sessions.empty() || options.from || options.until) && !points && !options.grid &&
      options.trajectory.empty()) {
    throw UsageError("--session, --from and --until are for points, grids and trajectories.");
  }
}

void check_rasters(const ExportCommandOptions& options) {
  const auto ends = [&](const char* extension) { return options.output->extension() == extension; };
  if (!options.raster.empty() && !ends(".tif") && !ends(".tiff") && !ends(".png")) {
    throw UsageError("-o " + options.output->string() +
                     ": rasters are GeoTIFF or PNG files; name it *.tif or *.png.");
  }
  if (options.grid && !ends(".yaml")) {
    throw UsageError("-o " + options.output->string() +
                     ": a grid is a YAML file with a picture beside it; name it *.yaml.");
  }
  if (options.cell && options.raster.empty() && !options.grid && !is_plan_raster(options) &&
      !options.contours) {
    throw UsageError(
        "--cell needs --raster, --elevation, --grid, --contours, or a plan as GeoTIFF.");
  }
  if (options.cell && !(*options.cell >= 0.005 && *options.cell <= 1e3)) {
    throw UsageError("--cell: must be between 0.005 and 1000 m.");
  }
  if (!options.heights.empty() && !options.grid) {
    throw UsageError("--heights needs --grid.");
  }
}

/// Nothing that is read is written over, be it by what comes beside the file.
void check_inputs(const ExportCommandOptions& options) {
  std::vector<fs::path> written = {options.output.value_or(fs::path())};
  for (const char* beside : {".pgm", ".pgw"}) {
    if (options.grid || !options.raster.empty()) {
      written.push_back(fs::path(written.front()).replace_extension(beside));
    }
  }
  for (const fs::path& file : written) {
    for (const auto& input :
         {std::optional(options.map), options.recording, options.polygon, options.calibration}) {
      keep_input("-o", file, input.value_or(fs::path()));
    }
  }
}

void check_options(const ExportCommandOptions& options) {
  const std::array<bool, 14> wanted = {!options.trajectory.empty(),
                                       !options.graph.empty(),
                                       !options.cloud.empty() || options.tiles.has_value(),
                                       !options.dense.empty(),
                                       !options.raster.empty(),
                                       options.grid,
                                       !options.slice.empty(),
                                       !options.section.empty(),
                                       options.plan,
                                       options.contours.has_value(),
                                       options.elevation,
                                       options.report,
                                       options.picture,
                                       options.dump};
  if (std::ranges::count(wanted, true) != 1) {
    throw UsageError(
        "say what to export: one of --trajectory, --graph, --cloud, --dense, --tiles, --raster, "
        "--elevation, --grid, --slice, --section, --plan, --contours, --report, --picture and "
        "--dump.");
  }
  if (!options.dump && !options.output) {
    throw UsageError("say where to: -o FILE.");
  }
  if (options.resolution && options.cloud.empty() && !options.tiles) {
    throw UsageError("--resolution needs --cloud or --tiles.");
  }
  if (options.report && options.output->extension() != ".html") {
    throw UsageError("-o " + options.output->string() + ": a report is a page; name it *.html.");
  }
  if (options.picture && !is_picture(*options.output)) {
    throw UsageError("-o " + options.output->string() +
                     ": pictures are SVG or PNG files; name it *.svg or *.png.");
  }
  if (options.resolution && !(*options.resolution >= 1e-3 && *options.resolution <= 1e3)) {
    throw UsageError("--resolution: must be between 0.001 and 1000 m.");
  }
  if (options.tiles && !(*options.tiles >= 1.0 && *options.tiles <= 1e5 &&
                         *options.tiles == std::round(*options.tiles))) {
    throw UsageError("--tiles: must be a whole number of metres from 1 to 100000.");
  }
  if (options.recording && options.dense.empty() && options.raster != "intensity" &&
      !options.color) {
    throw UsageError("--recording needs --dense, --raster intensity or --colorize.");
  }
  check_rasters(options);
  check_plan_options(options);
  check_class_options(options);
  check_color_options(options);
  check_frames(options);
  check_selection(options);
  check_inputs(options);
  std::error_code ignored;
  if (options.tiles && fs::exists(*options.output, ignored)) {
    throw UsageError("-o " + options.output->string() +
                     ": it exists. Name another folder for the tiles.");
  }
}

std::string export_dump(const ExportJob& job) {
  OutputFile file(job.file);
  std::size_t lines = 0;
  job.map->dump([&](std::string_view line) {
    file.write(line);
    file.write("\n");
    ++lines;
  });
  file.close();
  return fmt::format("{} lines", lines);
}

/// Writes what is asked for and says what that was.
std::string write(const ExportJob& job) {
  const ExportCommandOptions& options = *job.options;
  if (options.dump) {
    return export_dump(job);
  }
  if (!options.dense.empty()) {
    return export_dense(job);
  }
  if (options.picture) {
    return export_picture(
        job, options.output->extension() == ".png" ? PictureFormat::png : PictureFormat::svg);
  }
  if (!options.trajectory.empty()) {
    return export_trajectory(job);
  }
  if (!options.graph.empty()) {
    return export_graph(job);
  }
  if (!options.raster.empty()) {
    return options.raster == "color" ? export_orthophoto(job) : export_raster(job);
  }
  if (options.grid) {
    return export_grid(job);
  }
  if (options.report) {
    return export_report(job);
  }
  if (is_plan(options)) {
    return options.plan        ? export_plan(job)
           : options.contours  ? export_contours(job)
           : options.elevation ? export_elevation(job)
                               : export_slice(job);
  }
  return options.tiles ? export_tiles(job) : export_cloud(job);
}

int run(const ExportCommandOptions& options, std::ostream& out, std::ostream& err) {
  check_options(options);
  static_cast<void>(find_map(options.map));
  const MemoryLimit memory(options.max_ram_bytes, kWorkingBytes);
  const MapDatabase map(options.map, MapAccess::read);
  if (options.dump && !options.output) {
    map.dump([&](std::string_view line) { out << line << "\n"; });
    return 0;
  }
  ExportJob job{.map = &map,
                .options = &options,
                .file = *options.output,
                .georeference = options.origin ? parse_origin(*options.origin) : map.georeference(),
                .memory = &memory,
                .out = &out,
                .err = &err};
  // What cannot be completed leaves what was there; devices and pipes have no place to take.
  std::error_code ignored;
  std::optional<Draft> draft;
  if (!options.plan &&
      (!fs::exists(*options.output, ignored) || fs::is_regular_file(*options.output, ignored))) {
    draft.emplace(*options.output);
    job.file = draft->path();
  }
  std::string wrote;
  try {
    if (options.find_moving || !options.clean.empty()) {
      job.moved = find_moving(job, out);
    }
    if (options.without_gone) {
      job.gone = find_gone(job, out);
    }
    wrote = write(job);
  } catch (const std::invalid_argument& error) {
    throw UsageError(std::string("the map reaches beyond the projection: ") + error.what() +
                     " Choose another --frame.");
  } catch (const NoSuchSystem& error) {
    throw UsageError(std::string("the map reaches beyond --crs: ") + error.what() + ".");
  }
  if (draft) {
    draft->take_its_place();
  }
  out << (options.plan ? wrote : "wrote  " + options.output->string() + " (" + wrote + ")\n");
  return 0;
}

}  // namespace

int export_command(const ExportCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit export", out, err, [&] {
    ExportCommandOptions found = options;
    found.map = map_file(options.map);
    found.color = options.color || options.raster == "color";
    return run(found, out, err);
  });
}

void add_export_command(Command app, std::function<void(int)> done) {
  const Command command = app.add_command("export", "Write what a map holds in another format");
  const auto options = std::make_shared<ExportCommandOptions>();
  command.footer(
      "OUT is the folder of a run, MAP the map in it, OUT/map.adit. Without --frame, points and "
      "poses\n"
      "are in the map's frame, m; of a map that is georeferenced LAS files, tiles, rasters and "
      "plans\n"
      "are in UTM.\n"
      "\nExamples:\n"
      "  adit export out --trajectory tum -o trajectory.tum\n"
      "  adit export out --graph g2o -o graph.g2o\n"
      "  adit export out --cloud pcd --resolution 0.1 -o cloud.pcd\n"
      "  adit export out --cloud las --origin 48.1,11.5,520,90 -o cloud.las\n"
      "  adit export out --cloud las --find-moving --without-moving -o static.las\n"
      "  adit export out --cloud laz --classify --clean mark -o classes.laz\n"
      "  adit export out --dense ply -o dense.ply\n"
      "  adit export out --dense laz --colorize -o colors.laz\n"
      "  adit export out --raster color -o orthophoto.tif\n"
      "  adit export out --tiles 20 -o autoware\n"
      "  adit export out --raster height --cell 0.5 -o height.tif\n"
      "  adit export out --elevation -o elevation.tif\n"
      "  adit export out --grid -o grid.yaml\n"
      "  adit export out --plan -o plan.dxf\n"
      "  adit export out --report -o report.html\n"
      "  adit export out --picture -o map.png\n"
      "  adit export out --dump | sha256sum\n\n"
      "Exit codes: 0 done, 1 the map cannot be read or the file not written, 2 usage.");
  command.option("map", options->map, "The map, or the folder of its run")
      .required()
      .value_name("MAP|OUT");
  command.option("-o,--output", options->output, "The file to write").value_name("FILE").written();
  command
      .option("--trajectory", options->trajectory,
              "The pose of every sweep: tum, kitti, csv, geojson, kml, gpkg")
      .one_of({"tum", "kitti", "csv", "geojson", "kml", "gpkg"})
      .value_name("FORMAT");
  command.option("--graph", options->graph, "Keyframes and edges: g2o")
      .one_of({"g2o"})
      .value_name("FORMAT");
  command.option("--cloud", options->cloud, "The points of all submaps: ply, pcd, las, laz, copc")
      .one_of({"ply", "pcd", "las", "laz", "copc"})
      .value_name("FORMAT");
  command
      .option(
          "--dense", options->dense,
          "Every return of the recording with intensity, time and ring: ply, pcd, las, laz, copc")
      .one_of({"ply", "pcd", "las", "laz", "copc"})
      .value_name("FORMAT");
  command
      .option("--recording", options->recording,
              "Where the recording of a dense cloud and of colours is, if not where it was mapped")
      .value_name("REC");
  add_color_options(command, *options);
  command.option("--resolution", options->resolution, "One point of the cloud a voxel of this (m)")
      .value_name("M");
  command
      .option("--tiles", options->tiles,
              "The points of all submaps in squares of this (m), a file each, in a folder with the "
              "index that Autoware reads; --cloud chooses their format (pcd)")
      .value_name("M");
  command
      .option(
          "--raster", options->raster,
          "The map from above as GeoTIFF, or PNG with world file by FILE's end: height (of the "
          "highest point), ground (its height), intensity (of the recording's returns), color (of "
          "the highest surface whose upper side was seen, by the recording's cameras)")
      .one_of({"height", "intensity", "ground", "color"})
      .value_name("WHAT");
  command.flag("--grid", options->grid,
               "Occupancy grid of ROS map_server: a YAML file, and its PGM beside it");
  add_plan_options(command, *options);
  command
      .option(
          "--cell", options->cell,
          "Size of cells (m); 0.25 of rasters and elevation maps, 0.1 of --raster color, 0.05 of "
          "grids and plans, 0.5 of contours")
      .value_name("M");
  command.flag("--report", options->report,
               "A page to print: coordinates, coverage, loops, warnings, a picture, versions");
  command
      .option("--heights", options->heights,
              "What stands in the way in a grid: LOW,HIGH above the sensor (m), -0.3,0.3; what is "
              "lower is ground")
      .value_name("LOW,HIGH");
  command
      .option("--frame", options->frame, "Coordinates: map, local (east, north, up), utm, geodetic")
      .one_of({"map", "local", "utm", "geodetic"})
      .value_name("FRAME");
  command.option("--utm", options->utm, "The zone of UTM, such as 30N; otherwise the origin's")
      .value_name("ZONE");
  command
      .option("--crs", options->crs,
              "Coordinates of a projected system by name, such as EPSG:25830; needs PROJ")
      .value_name("NAME");
  command
      .option("--geoid", options->geoid,
              "Heights above the sea, by a file of GeographicLib's, such as egm2008-1.pgm")
      .value_name("FILE");
  command
      .option("--origin", options->origin,
              "Places a map by hand: LAT,LON,ALT[,YAW] of its origin (degrees, m above the "
              "ellipsoid; its x axis counter-clockwise from east)")
      .value_name("PLACE");
  command.option("--box", options->box, "Points within X0,Y0,X1,Y1 of the product's frame (m)")
      .value_name("BOX");
  command
      .option("--polygon", options->polygon,
              "Points within a polygon: a GeoJSON file, or a line \"x y\" a corner")
      .value_name("FILE");
  command.option("--session", options->sessions, "Of this session alone; may be repeated")
      .one_value_each()
      .value_name("ID");
  constexpr double kFarthest = 9e9;  // s, what stamps can say
  command.option("--from", options->from, "From this stamp on (s)")
      .from(-kFarthest, kFarthest)
      .value_name("S");
  command.option("--until", options->until, "Up to this stamp (s)")
      .from(-kFarthest, kFarthest)
      .value_name("S");
  command.flag("--without-moving", options->without_moving,
               "Without points that other sweeps saw through; LAS files have them as class 64");
  command.flag(
      "--without-gone", options->without_gone,
      "Without what later sessions, up to --until, saw to be gone: the place as it is now, "
      "or as it was then");
  command.flag("--find-moving", options->find_moving,
               "Looks for what has moved from one submap to the next, too, on the device: some "
               "tenths of a second a keyframe in software");
  add_class_options(command, *options);
  add_device_options(command, options->device);
  add_max_ram_option(command, options->max_ram_bytes);
  command.flag(
      "--picture", options->picture,
      "The map from above with its graph, path, scale and legend: SVG, or PNG by FILE's end");
  command.flag("--dump", options->dump,
               "All content as text, for comparing; to the standard output without -o");
  command.action(
      [options, done = std::move(done)] { done(export_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
