// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_deliver.hpp"

#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/commands/command_export.hpp"
#include "adit/tools/export/export_job.hpp"
#include "adit/tools/export/export_options.hpp"
#include "adit/tools/map_database/map_location.hpp"
#include "adit/tools/results/kept_inputs.hpp"
#include "adit/tools/run/earlier_run.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

std::vector<DeliveryProduct> products_of(const DeliverCommandOptions& options) {
  return options.preset ? parse_delivery(read_text_file(*options.preset), *options.preset)
                        : parse_delivery(default_delivery(), "the built-in preset");
}

/// Whether a file of the recording can be read still.
bool has_recording(const MapDatabase& map, const DeliveryPlace& place) {
  if (place.recording) {
    return true;
  }
  const std::vector<MapSession> sessions = map.sessions();
  if (sessions.size() != 1) {
    return false;
  }
  const std::vector<fs::path> paths = recordings_of(sessions.front());
  std::error_code error;
  return !paths.empty() &&
         std::ranges::all_of(paths, [&](const fs::path& path) { return fs::exists(path, error); });
}

/// Runs `adit export` with these words. Returns its exit code.
int run_export(const fs::path& map, const fs::path& file, const std::vector<std::string>& words) {
  std::vector<std::string> all = {"adit", "export", map.string()};
  all.insert(all.end(), words.begin(), words.end());
  all.insert(all.end(), {"-o", file.string()});
  std::vector<const char*> given;
  for (const std::string& word : all) {
    given.push_back(word.c_str());
  }
  const CommandLine line("adit", "");
  int code = 0;
  add_export_command(line.program(), [&code](int command_code) { code = command_code; });
  return line.run(static_cast<int>(given.size()), given.data()).value_or(code);
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || !fs::is_directory(folder, error)) {
    throw OutputError(folder,
                      folder.string() + ": cannot be made a folder. Name another one with -o.");
  }
}

/// What a product needs and the map has not.
enum class Missing { nothing, place, recording, cameras };

Missing missing_for(const DeliveryProduct& product, const MapDatabase& map,
                    const DeliveryPlace& place, bool colors) {
  return product.needs_place && !place.on_earth                  ? Missing::place
         : product.needs_recording && !has_recording(map, place) ? Missing::recording
         : product.needs_cameras && !colors                      ? Missing::cameras
                                                                 : Missing::nothing;
}

/// Whether points get colours; says why where they do not and some product wants them.
bool check_colors(const std::vector<DeliveryProduct>& wanted, const MapDatabase& map,
                  const DeliveryPlace& place, const fs::path& folder, std::ostream& err) {
  if (std::ranges::none_of(wanted, wants_colors)) {
    return false;
  }
  const std::string why = why_no_colors(map, place, folder);
  if (!why.empty()) {
    err << "note: clouds have no colours (" << why << ")\n";
  }
  return why.empty();
}

/// A page of somebody else's stays.
void check_folder(const fs::path& folder, const fs::path& page) {
  std::error_code error;
  if (fs::exists(page, error) && !DeliveryRecord::is_in(folder)) {
    throw UsageError("-o " + folder.string() + ": its " + page.filename().string() +
                     " is not one of a delivery. Name another folder.");
  }
}

struct Delivered {
  std::vector<DeliveryProduct> there{};
  std::size_t failed = 0;
};

Delivered write_products(const std::vector<DeliveryProduct>& wanted, const MapDatabase& map,
                         const DeliveryPlace& place, const fs::path& folder, std::ostream& out,
                         std::ostream& err) {
  const bool colors = check_colors(wanted, map, place, folder, err);
  std::vector<fs::path> inputs = {map.file()};
  for (const auto& input : {place.geoid, place.recording, place.calibration}) {
    if (input) {
      inputs.push_back(*input);
    }
  }
  DeliveryRecord record(folder);
  Delivered delivered;
  for (const DeliveryProduct& one : wanted) {
    const DeliveryProduct product = colors ? one : without_colors(one);
    const std::vector<std::string> words = export_words(product, place);
    const std::string state = delivery_state(inputs, words);
    const Missing missing = missing_for(product, map, place, colors);
    if (missing == Missing::nothing && record.has(product, state)) {
      out << "kept   " << (folder / product.file).string() << "\n";
      delivered.there.push_back(product);
      continue;
    }
    record.remove(product);
    if (missing != Missing::nothing) {
      err << "left out  " << product.file << " ("
          << (missing == Missing::place     ? "the map has no place on the Earth: --origin PLACE"
              : missing == Missing::cameras ? "there are no colours, see above"
                                            : "the recording is not there: --recording REC")
          << ")\n";
    } else if (run_export(map.file(), folder / product.file, words) == 0) {
      record.add(product, state);
      delivered.there.push_back(product);
    } else if (product.optional) {
      err << "left out  " << product.file << " (see the message above)\n";
    } else {
      ++delivered.failed;
    }
  }
  return delivered;
}

int deliver(const DeliverCommandOptions& options, std::ostream& out, std::ostream& err) {
  const std::vector<DeliveryProduct> wanted = products_of(options);
  const fs::path file = find_map(options.map);
  const MapDatabase map(file, MapAccess::read);
  DeliveryPlace place = options.place;
  place.on_earth = place.origin || map.georeference();
  const std::string system = delivery_system(map, place);
  const fs::path page = options.folder / "README.md";
  check_folder(options.folder, page);
  make_folder(options.folder);
  for (const DeliveryProduct& product : wanted) {
    keep_input("-o", options.folder / product.file, file);
  }
  const Delivered delivered = write_products(wanted, map, place, options.folder, out, err);
  replace_text_file(page, delivery_page(map, system, delivered.there, options.folder));
  out << "wrote  " << page.string() << "\n";
  if (delivered.failed > 0) {
    err << fmt::format(
        "adit deliver: {} of {} files could not be written. The same command completes them.\n",
        delivered.failed, wanted.size());
  }
  return delivered.failed > 0 ? 1 : 0;
}

}  // namespace

int deliver_command(const DeliverCommandOptions& options, std::ostream& out, std::ostream& err) {
  return guarded("adit deliver", out, err, [&] {
    if (options.print_preset) {
      out << default_delivery();
      return 0;
    }
    if (options.map.empty() || options.folder.empty()) {
      throw UsageError("say which map, and where to: adit deliver MAP|OUT -o FOLDER.");
    }
    return deliver(options, out, err);
  });
}

void add_deliver_command(Command app, std::function<void(int)> done) {
  const Command command = app.add_command("deliver", "Write all that a client gets of a map");
  const auto options = std::make_shared<DeliverCommandOptions>();
  command.footer(
      "OUT is the folder of a run, MAP the map in it, OUT/map.adit. The folder gets clouds (COPC, "
      "LAZ), rasters, an occupancy grid, pictures, the trajectory, a report, and README.md, which "
      "says what each is. Clouds are in colours, and there is an orthophoto, if the recording has "
      "cameras with a calibration. Files that are there already are kept: run an interrupted "
      "command again. "
      "A "
      "preset (TOML) says what is written.\n\n"
      "Examples:\n"
      "  adit deliver out -o delivery\n"
      "  adit deliver out -o delivery --crs EPSG:25832 --geoid egm2008-1.pgm\n"
      "  adit deliver --print-preset > ours.toml\n"
      "  adit deliver out -o delivery --preset ours.toml\n\n"
      "Exit codes: 0 done, 1 the map cannot be read or a file not written, 2 usage.");
  command.option("map", options->map, "The map, or the folder of its run").value_name("MAP|OUT");
  command.option("-o,--output", options->folder, "The folder; what it holds already is completed")
      .value_name("FOLDER");
  command.option("--preset", options->preset, "What to write; TOML").value_name("FILE");
  command.flag("--print-preset", options->print_preset, "Print the preset that is used otherwise");
  command
      .option("--origin", options->place.origin,
              "Places a map by hand: LAT,LON,ALT[,YAW] of its origin")
      .value_name("PLACE");
  command
      .option("--crs", options->place.crs,
              "Coordinates of a projected system by name, such as EPSG:25830; otherwise UTM")
      .value_name("NAME");
  command
      .option("--geoid", options->place.geoid,
              "Heights above the sea, by a file of GeographicLib's")
      .value_name("FILE");
  command
      .option("--recording", options->place.recording,
              "Where the recording is, if not where it was mapped")
      .value_name("REC");
  command
      .option("--calibration", options->place.calibration,
              "A file of cameras, for the colours, as of adit export")
      .value_name("FILE");
  command.action(
      [options, done = std::move(done)] { done(deliver_command(*options, std::cout, std::cerr)); });
}

}  // namespace adit
