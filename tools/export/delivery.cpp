// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/delivery.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <iterator>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/text.hpp"
#include "adit/tools/clouds/las_layout.hpp"
#include "adit/tools/export/dense_recording.hpp"
#include "adit/tools/export/export_job.hpp"
#include "adit/tools/export/export_options.hpp"
#include "adit/tools/support/fingerprint.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/toml_table.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRecordFile = "delivery.json";
constexpr const char* kPageFile = "README.md";
constexpr const char* kPresetRemedy =
    "`adit deliver --print-preset` prints one that can be changed";

constexpr std::string_view kDefault = R"(# What `adit deliver` writes, a [[product]] each:
#   file    its name in the folder
#   export  the options of `adit export` that write it, without the map, -o and the coordinates
#   about   a sentence for whoever gets it
#   needs   "place": the map has to lie on the Earth; "recording": its recording has to be there;
#           "cameras": that has to have cameras with a calibration; "content": left out where the map
#           has nothing for it
# A product whose needs are not met is left out, with a note. So is --colorize where there are no
# such cameras.

[[product]]
file = "cloud.copc.laz"
export = "--cloud copc --classify --colorize"
about = "The point cloud with an octree: opens at once in QGIS, CloudCompare and Potree, whatever its size; ground is class 2."

[[product]]
file = "cloud.laz"
export = "--cloud laz --resolution 0.05 --classify --colorize"
about = "The point cloud, a point every 5 cm, for programs that read LAZ; ground is class 2."

[[product]]
file = "orthophoto.tif"
export = "--raster color --cell 0.1"
about = "The colours of the surface from above (GeoTIFF), 10 cm a cell; ceilings are left out, so that floors show."
needs = "cameras"

[[product]]
file = "height.tif"
export = "--raster height --cell 0.25"
about = "Heights from above (GeoTIFF), 25 cm a cell."

[[product]]
file = "intensity.tif"
export = "--raster intensity --cell 0.1"
about = "The intensity of the returns from above (GeoTIFF), 10 cm a cell: markings, signs, edges of roads."
needs = "recording"

[[product]]
file = "plan.dxf"
export = "--plan"
about = "Floor plans (DXF): plan_0.dxf of the lowest storey, and so on; walls as lines, 1.2 m above the floor."
needs = "content"

[[product]]
file = "grid.yaml"
export = "--grid --cell 0.05"
about = "Occupancy grid for navigation (ROS map_server) with grid.pgm."

[[product]]
file = "map.png"
export = "--picture"
about = "The map from above with the path."

[[product]]
file = "trajectory.csv"
export = "--trajectory csv"
about = "Where the sensor was, a line a sweep."

[[product]]
file = "trajectory.gpkg"
export = "--trajectory gpkg"
about = "The path and the graph (GeoPackage), for QGIS."
needs = "place"

[[product]]
file = "trajectory.kml"
export = "--trajectory kml"
about = "The path for Google Earth."
needs = "place"

[[product]]
file = "report.html"
export = "--report"
about = "The report: coordinates, coverage, accuracy, warnings. To read and to print."
)";

DeliveryProduct parse_product(const TomlTable& table) {
  constexpr std::array<std::string_view, 4> kKeys = {"file", "export", "about", "needs"};
  table.require_only(kKeys, "a product");
  DeliveryProduct product{.file = table.text("file").value_or(""),
                          .about = table.text("about").value_or("")};
  if (product.file.empty() || fs::path(product.file).filename() != product.file ||
      product.file == kRecordFile || product.file == kPageFile || product.file.starts_with('.')) {
    table.refuse("'" + product.file + "' is no name of a file in the folder");
  }
  const std::string words = table.text("export").value_or("");
  for (const std::string_view word : split_words(words)) {
    product.options.emplace_back(word);
  }
  if (product.options.empty()) {
    table.refuse(product.file + " has no export");
  }
  for (const std::string& word : product.options) {
    if (word == "-o" || word == "--output" || word == "--help" || word == "-h" ||
        word.find('=') != std::string::npos) {
      table.refuse("'" + word + "' cannot be in export");
    }
  }
  if (product.about.find_first_of("|\n") != std::string::npos) {
    table.refuse("about is one line without '|'");
  }
  const std::string needs = table.text("needs").value_or("");
  product.needs_place = needs == "place";
  product.needs_recording = needs == "recording";
  product.needs_cameras = needs == "cameras";
  product.optional = needs == "content";
  if (!needs.empty() && !product.needs_place && !product.needs_recording &&
      !product.needs_cameras && !product.optional) {
    table.refuse("needs", "needs is '" + needs + "': place, recording, cameras or content");
  }
  return product;
}

std::string size_text(uint64_t bytes) {
  return bytes < 1000        ? fmt::format("{} B", bytes)
         : bytes < 1'000'000 ? fmt::format("{:.0f} kB", static_cast<double>(bytes) * 1e-3)
                             : fmt::format("{:.1f} MB", static_cast<double>(bytes) * 1e-6);
}

/// The days of a survey, where its stamps are dates.
std::string dates_of(const MapDatabase& map) {
  const std::vector<MapKeyframe> keyframes = map.keyframes();
  if (keyframes.empty() || !is_unix_time(keyframes.front().stamp)) {
    return {};
  }
  const auto [first, last] = std::ranges::minmax(keyframes, {}, &MapKeyframe::stamp);
  const auto day = [](Nanoseconds stamp) {
    return fmt::format("{:%Y-%m-%d}", std::chrono::sys_time<std::chrono::seconds>(
                                          std::chrono::duration_cast<std::chrono::seconds>(stamp)));
  };
  return day(first.stamp) == day(last.stamp)
             ? "Surveyed on " + day(first.stamp) + " (UTC).\n\n"
             : "Surveyed from " + day(first.stamp) + " to " + day(last.stamp) + " (UTC).\n\n";
}

bool is_orthophoto(const DeliveryProduct& product) {
  const auto raster = std::ranges::find(product.options, "--raster");
  return raster != product.options.end() && std::next(raster) != product.options.end() &&
         *std::next(raster) == "color";
}

/// What the page says of the colours of clouds; nothing where there are no clouds.
std::string colors_text(const std::vector<DeliveryProduct>& products) {
  const auto is_cloud = [](const DeliveryProduct& product) {
    return std::ranges::any_of(product.options, [](const std::string& word) {
      return word == "--cloud" || word == "--dense" || word == "--tiles";
    });
  };
  std::string colored;
  for (const DeliveryProduct& product : products) {
    if (is_cloud(product) && wants_colors(product)) {
      colored += (colored.empty() ? "`" : ", `") + product.file + "`";
    }
  }
  return !colored.empty() ? "\nPoints have the colours that cameras saw, in " + colored +
                                ". Points that no camera saw are black.\n"
         : std::ranges::any_of(products, is_cloud) ? "\nThe points of the clouds have no colours.\n"
                                                   : "";
}

/// How coordinates are chosen for a product.
enum class Coordinates {
  of_map,      ///< always the map's frame
  degrees,     ///< always latitude and longitude
  all,         ///< a column each
  geopackage,  ///< degrees, or a projected system that is named
  stated,      ///< the file states its system: UTM by itself
  unstated,    ///< points and poses alone: a frame has to be named
};

Coordinates coordinates_kind(const DeliveryProduct& product) {
  const auto has = [&](std::string_view word) {
    return std::ranges::count(product.options, word) > 0;
  };
  return has("--picture") || has("--graph") || has("--dump") || has("--grid") ? Coordinates::of_map
         : has("kml") || has("geojson")                                       ? Coordinates::degrees
         : has("csv")                                                         ? Coordinates::all
         : has("gpkg")                                            ? Coordinates::geopackage
         : has("ply") || has("pcd") || has("tum") || has("kitti") ? Coordinates::unstated
                                                                  : Coordinates::stated;
}

}  // namespace

std::string_view default_delivery() {
  return kDefault;
}

std::vector<DeliveryProduct> parse_delivery(std::string_view text, const fs::path& file) {
  const TomlFile preset(text, file, kPresetRemedy);
  const TomlTable table(preset);
  constexpr std::array<std::string_view, 1> kKeys = {"product"};
  table.require_only(kKeys, "a preset");
  std::vector<DeliveryProduct> products;
  std::set<std::string> names;
  for (const TomlTable& one : table.tables("product")) {
    products.push_back(parse_product(one));
    if (!names.insert(products.back().file).second) {
      one.refuse(products.back().file + " stands twice");
    }
  }
  if (products.empty()) {
    throw InputError(file, {}, "it has no [[product]]", kPresetRemedy);
  }
  return products;
}

bool wants_colors(const DeliveryProduct& product) {
  return std::ranges::count(product.options, "--colorize") > 0 || is_orthophoto(product);
}

DeliveryProduct without_colors(DeliveryProduct product) {
  std::erase(product.options, "--colorize");
  return product;
}

std::string why_no_colors(const MapDatabase& map, const DeliveryPlace& place,
                          const fs::path& folder) {
  ExportCommandOptions options;
  options.map = map.file();
  options.output = folder;
  options.recording = place.recording;
  options.calibration = place.calibration;
  const ExportJob job{.map = &map, .options = &options, .file = {}};
  try {
    static_cast<void>(DenseRecording(job).cameras());
    return "";
  } catch (const FileError& error) {
    return error.what();
  }
}

std::vector<std::string> export_words(const DeliveryProduct& product, const DeliveryPlace& place) {
  std::vector<std::string> words = product.options;
  const auto has = [&](std::string_view word) { return std::ranges::count(words, word) > 0; };
  const auto add = [&](const char* option, const std::string& value) {
    words.emplace_back(option);
    words.push_back(value);
  };
  const bool colors = wants_colors(product);
  if (place.recording && (has("--dense") || has("intensity") || colors)) {
    add("--recording", place.recording->string());
  }
  if (place.calibration && colors) {
    add("--calibration", place.calibration->string());
  }
  const Coordinates kind = coordinates_kind(product);
  if (kind == Coordinates::of_map) {
    return words;
  }
  if (place.origin) {
    add("--origin", *place.origin);
  }
  const bool chosen = has("--crs") || has("--utm") || has("--frame");
  if (place.crs && kind != Coordinates::degrees && !chosen) {
    add("--crs", *place.crs);
  } else if (!chosen && place.on_earth &&
             (kind == Coordinates::unstated || (kind == Coordinates::geopackage && place.geoid))) {
    add("--frame", "utm");
  }
  if (place.geoid && !has("geojson")) {
    add("--geoid", place.geoid->string());
  }
  return words;
}

std::string coordinates_of_product(const DeliveryProduct& product, const std::string& system) {
  const std::string frame = system.empty() ? "the map's frame" : system;
  switch (coordinates_kind(product)) {
    case Coordinates::of_map:
      return "the map's frame";
    case Coordinates::degrees:
      return "degrees (WGS 84)";
    case Coordinates::all:
      return "a column each";
    case Coordinates::geopackage:
      return "see its layers";
    case Coordinates::stated:
    case Coordinates::unstated:
      break;
  }
  return frame;
}

std::vector<fs::path> files_of_product(const DeliveryProduct& product, const fs::path& folder) {
  const fs::path name = product.file;
  const std::string stem = name.stem().string();
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path file = entry->path().filename();
    const std::string rest =
        file.stem().string().substr(std::min(stem.size(), file.stem().string().size()));
    const bool numbered = file.stem().string().starts_with(stem + "_") && rest.size() > 1 &&
                          rest.find_first_not_of("0123456789", 1) == std::string::npos &&
                          file.extension() == name.extension();
    const bool beside =
        file.stem() == name.stem() && (file.extension() == ".pgm" || file.extension() == ".pgw");
    if (file == name || numbered || beside) {
      files.push_back(entry->path());
    }
  }
  std::ranges::sort(files);
  return files;
}

std::string delivery_state(const std::vector<fs::path>& inputs,
                           const std::vector<std::string>& words) {
  std::string state = std::string(version());
  for (const fs::path& input : inputs) {
    state += ' ' + fingerprint(input).hash;
  }
  for (const std::string& word : words) {
    state += ' ' + word;
  }
  return state;
}

DeliveryRecord::DeliveryRecord(fs::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  if (!fs::exists(folder_ / kRecordFile, error)) {
    return;
  }
  const nlohmann::json record =
      nlohmann::json::parse(read_text_file(folder_ / kRecordFile), nullptr, false);
  if (record.is_object()) {
    for (const auto& [file, state] : record.items()) {
      made_[file] = state.is_string() ? state.get<std::string>() : std::string();
    }
  }
}

bool DeliveryRecord::is_in(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / kRecordFile, error);
}

bool DeliveryRecord::has(const DeliveryProduct& product, const std::string& state) const {
  const auto made = made_.find(product.file);
  return made != made_.end() && made->second == state &&
         !files_of_product(product, folder_).empty();
}

void DeliveryRecord::add(const DeliveryProduct& product, const std::string& state) {
  made_[product.file] = state;
  keep();
}

void DeliveryRecord::remove(const DeliveryProduct& product) {
  if (made_.erase(product.file) == 0) {
    return;
  }
  keep();
  for (const fs::path& file : files_of_product(product, folder_)) {
    std::error_code ignored;
    fs::remove(file, ignored);
  }
}

void DeliveryRecord::keep() const {
  nlohmann::ordered_json record = nlohmann::ordered_json::object();
  for (const auto& [name, state] : made_) {
    record[name] = state;
  }
  replace_text_file(folder_ / kRecordFile, record.dump(2) + "\n");
}

std::string delivery_system(const MapDatabase& map, const DeliveryPlace& place) {
  ExportCommandOptions options;
  options.map = map.file();
  options.origin = place.origin;
  options.crs = place.crs;
  options.geoid = place.geoid;
  const MemoryLimit memory(0, 0);
  const ExportJob job{
      .map = &map,
      .options = &options,
      .file = {},
      .georeference = place.origin ? parse_origin(*place.origin) : map.georeference(),
      .memory = &memory};
  const ProductCoordinates coordinates = coordinates_of(job, true);
  return coordinates.frame() == ProductFrame::map ? "" : coordinates.name();
}

std::string delivery_page(const MapDatabase& map, const std::string& system,
                          const std::vector<DeliveryProduct>& products, const fs::path& folder) {
  std::string page = "# Survey\n\n" + dates_of(map);
  page += "Lengths are in metres. The map's frame begins where the survey began, with z up.\n";
  if (system.empty()) {
    page += "The map has no place on the Earth.\n";
  }
  page += "\n| file | size | coordinates | what it is |\n|---|---|---|---|\n";
  for (const DeliveryProduct& product : products) {
    uint64_t bytes = 0;
    for (const fs::path& file : files_of_product(product, folder)) {
      std::error_code error;
      const auto size = fs::file_size(file, error);
      bytes += error ? 0 : size;
    }
    page += fmt::format("| `{}` | {} | {} | {} |\n", product.file, size_text(bytes),
                        coordinates_of_product(product, system), product.about);
  }
  page += colors_text(products);
  page += fmt::format("\nMade by adit {} of a map of {} keyframes in {} session{}.\n", version(),
                      map.keyframes().size(), map.sessions().size(),
                      map.sessions().size() == 1 ? "" : "s");
  return page;
}

}  // namespace adit
