// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_volume.hpp"

#include <iostream>
#include <memory>
#include <stdexcept>
#include <utility>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/shared_options.hpp"
#include "adit/tools/support/progress.hpp"
#include "adit/tools/support/stop_signal.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

constexpr int kVolumeStopped = 128;

int measure(const VolumeCommandOptions& options, std::ostream& out, std::ostream& err) {
  const StopSignal stop;
  Progress progress(err, options.quiet ? ProgressStyle::none : progress_style_of_stderr(),
                    "compare", kUnknownTotal, Progress::Clock::now(), "steps");
  std::size_t searched = 0;
  try {
    const VolumeOutcome outcome = volume_job(options, [&](const MergeStep&) {
      progress.update(++searched, 0);
      return StopSignal::received() == 0;
    });
    progress.finish();
    out << (options.json ? to_json(options, outcome) : describe_volume(options, outcome));
    return 0;
  } catch (const MergeStopped&) {
    progress.finish();
    err << "adit volume: stopped; nothing was written" << std::endl;
    return kVolumeStopped + StopSignal::received();
  } catch (const std::invalid_argument& error) {
    throw UsageError(std::string("the map reaches beyond the projection: ") + error.what() +
                     " Choose another --frame.");
  }
}

void add_place_options(const Command& command, VolumeCommandOptions& options) {
  ExportCommandOptions& place = options.place;
  command.option("--box", place.box, "Within X0,Y0,X1,Y1 of the product's frame (m)")
      .value_name("BOX");
  command
      .option("--polygon", place.polygon,
              "Within a polygon: a GeoJSON file, or a line \"x y\" a corner; ground outside of it "
              "counts as unchanged")
      .value_name("FILE");
  command.option("--frame", place.frame, "Coordinates: map, local (east, north, up), utm")
      .one_of({"map", "local", "utm"})
      .value_name("FRAME");
  command.option("--utm", place.utm, "The zone of UTM, such as 30N; otherwise the origin's")
      .value_name("ZONE");
  command
      .option("--crs", place.crs,
              "Coordinates of a projected system by name, such as EPSG:25830; needs PROJ")
      .value_name("NAME");
  command
      .option("--geoid", place.geoid,
              "Heights above the sea, by a file of GeographicLib's, such as egm2008-1.pgm")
      .value_name("FILE");
  command
      .option("--origin", place.origin,
              "Places a map by hand: LAT,LON,ALT[,YAW] of its origin (degrees, m above the "
              "ellipsoid; its x axis counter-clockwise from east)")
      .value_name("PLACE");
}

}  // namespace

int volume_command(const VolumeCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit volume", out, err, [&] { return measure(options, out, err); });
}

void add_volume_command(Command app, std::function<void(int)> done) {
  const Command command =
      app.add_command("volume", "Measure the volume between two maps, or of a heap");
  const auto options = std::make_shared<VolumeCommandOptions>();
  command.footer(
      "Of two maps the first is BEFORE and the second AFTER; they are tied to each other first, as "
      "`adit merge` does, and stay as they are. Of a map of several sessions the first and the "
      "last are compared. With --above it is the volume of a heap in one map.\n\n"
      "Heights are those of the ground, as `adit export --raster ground` has them. Errors are "
      "standard errors, measured where the ground has not changed. What was not seen in both maps "
      "is not in the volumes.\n\n"
      "Examples:\n"
      "  adit volume monday tuesday\n"
      "  adit volume monday tuesday --polygon heap.geojson --raster difference.tif\n"
      "  adit volume site.adit --before 1 --after 3 --json\n"
      "  adit volume out --above surroundings --box 10,-4,18,4\n\n"
      "Exit codes: 0 measured, 1 failed, 2 usage, 129, 130 or 143 stopped (nothing is written).");
  command.option("maps", options->maps, "One map, or BEFORE and AFTER; or their folders")
      .required()
      .value_name("MAP|OUT");
  command
      .option("--above", options->above,
              "Of one map, above a level plane at HEIGHT (m, product's frame), or above a plane "
              "through the ground within 2 m around the polygon: surroundings")
      .value_name("HEIGHT|surroundings");
  command.option("--before", options->before, "Session of one map that is before; may be repeated")
      .one_value_each()
      .value_name("ID");
  command.option("--after", options->after, "Session of one map that is after; may be repeated")
      .one_value_each()
      .value_name("ID");
  command.flag(
      "--as-georeferenced", options->as_georeferenced,
      "Two maps lie to each other as on the Earth: for places of which nothing has stayed");
  command.flag("--as-measured", options->as_measured,
               "Do not take off the common offset of heights that unchanged ground shows");
  add_place_options(command, *options);
  command
      .option("--raster", options->raster,
              "GeoTIFF of the difference of heights, and of the heights after and before")
      .value_name("FILE.tif")
      .written({".tif", ".tiff"});
  add_device_options(command, options->place.device);
  command.flag("--quiet", options->quiet, "Print errors and the report alone");
  command.flag("--json", options->json, "Report as JSON");
  command.action(
      [options, done = std::move(done)] { done(volume_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
