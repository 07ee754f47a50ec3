// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/export/delivery.hpp"

#include <algorithm>
#include <chrono>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/text.hpp"
#include "adit/tools/clouds/las_layout.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/toml.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRecordFile = "delivery.json";
constexpr const char* kPresetRemedy =
    "`adit deliver --print-preset` prints one that can be changed";

constexpr std::string_view kDefault = R"(# What `adit deliver` writes, a [[product]] each:
#   file    its name in the folder
#   export  what `adit export` is told to write it; the map, -o and where points are come by themselves
#   about   a sentence for whoever gets it
#   needs   "place": the map has to lie on the Earth; "recording": its recording has to be there
# What the needs of a product are not met for is left out, and said.

[[product]]
file = "cloud.copc.laz"
export = "--cloud copc"
about = "The point cloud with an octree: opens at once in QGIS, CloudCompare and Potree, whatever its size."

[[product]]
file = "cloud.laz"
export = "--cloud laz --resolution 0.05"
about = "The point cloud, a point every 5 cm, for programs that read LAZ."

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

[[product]]
file = "grid.yaml"
export = "--grid --cell 0.05"
about = "Occupancy grid for navigation (ROS map_server) with grid.pgm, in the frame of the map."

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

[[noreturn]] void refuse_preset(const fs::path& file, const toml::node& node,
                                const std::string& found) {
  throw InputError(file, Place::line(node.source().begin.line), found, kPresetRemedy);
}

std::string text_of(const toml::table& table, std::string_view key, const fs::path& file) {
  const toml::node* const node = table.get(key);
  if (node == nullptr) {
    return {};
  }
  const auto text = node->value<std::string>();
  if (!text) {
    refuse_preset(file, *node, std::string(key) + " is no text");
  }
  return *text;
}

DeliveryProduct parse_product(const toml::table& table, const fs::path& file) {
  for (const auto& [key, value] : table) {
    const std::string_view name = key.str();
    if (name != "file" && name != "export" && name != "about" && name != "needs") {
      refuse_preset(file, value,
                    "a product has no " + std::string(name) + ": file, export, about, needs");
    }
  }
  DeliveryProduct product{.file = text_of(table, "file", file),
                          .about = text_of(table, "about", file)};
  if (product.file.empty() || fs::path(product.file).filename() != product.file ||
      product.file == kRecordFile || product.file.starts_with('.')) {
    refuse_preset(file, table, "'" + product.file + "' is no name of a file in the folder");
  }
  const std::string words = text_of(table, "export", file);
  for (const std::string_view word : split_words(words)) {
    product.options.emplace_back(word);
  }
  if (product.options.empty()) {
    refuse_preset(file, table, product.file + " has no export");
  }
  const std::string needs = text_of(table, "needs", file);
  product.needs_place = needs == "place";
  product.needs_recording = needs == "recording";
  if (!needs.empty() && !product.needs_place && !product.needs_recording) {
    refuse_preset(file, table, "needs is '" + needs + "': place or recording");
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

std::string state_of(const std::string& map, const std::vector<std::string>& words) {
  std::string state = map;
  for (const std::string& word : words) {
    state += ' ' + word;
  }
  return state;
}

}  // namespace

std::string_view default_delivery() {
  return kDefault;
}

std::vector<DeliveryProduct> parse_delivery(std::string_view text, const fs::path& file) {
  toml::table preset;
  try {
    preset = toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw InputError(file, Place::line(error.source().begin.line),
                     "it is no TOML: " + std::string(error.description()), kPresetRemedy);
  }
  for (const auto& [key, value] : preset) {
    if (key.str() != "product") {
      refuse_preset(file, value,
                    "'" + std::string(key.str()) + "' is unknown; a preset has [[product]] alone");
    }
  }
  const toml::array* const list = preset.get_as<toml::array>("product");
  std::vector<DeliveryProduct> products;
  std::set<std::string> names;
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    const toml::table* const table = (*list)[i].as_table();
    if (table == nullptr) {
      refuse_preset(file, (*list)[i], "a product is a table, [[product]]");
    }
    products.push_back(parse_product(*table, file));
    if (!names.insert(products.back().file).second) {
      refuse_preset(file, *table, products.back().file + " stands twice");
    }
  }
  if (products.empty()) {
    throw InputError(file, {}, "it has no [[product]]", kPresetRemedy);
  }
  return products;
}

std::vector<std::string> export_words(const DeliveryProduct& product, const DeliveryPlace& place) {
  std::vector<std::string> words = product.options;
  const auto has = [&](std::string_view word) { return std::ranges::count(words, word) > 0; };
  const auto add = [&](const char* option, const std::string& value) {
    words.emplace_back(option);
    words.push_back(value);
  };
  const bool in_map_frame = has("--picture") || has("--graph") || has("--dump") || has("--grid");
  const bool geodetic = has("kml") || has("geojson");
  if (place.recording && (has("--dense") || has("intensity"))) {
    add("--recording", place.recording->string());
  }
  if (in_map_frame) {
    return words;
  }
  if (place.origin) {
    add("--origin", *place.origin);
  }
  if (place.crs && !geodetic) {
    add("--crs", *place.crs);
  }
  if (place.geoid) {
    add("--geoid", place.geoid->string());
  }
  return words;
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

bool DeliveryRecord::has(const std::string& file, const std::string& map,
                         const std::vector<std::string>& words) const {
  const auto made = made_.find(file);
  std::error_code error;
  return made != made_.end() && made->second == state_of(map, words) &&
         fs::exists(folder_ / file, error);
}

void DeliveryRecord::add(const std::string& file, const std::string& map,
                         const std::vector<std::string>& words) {
  made_[file] = state_of(map, words);
  nlohmann::ordered_json record;
  for (const auto& [name, state] : made_) {
    record[name] = state;
  }
  replace_text_file(folder_ / kRecordFile, record.dump(2) + "\n");
}

std::string delivery_page(const MapDatabase& map, const std::string& coordinates,
                          const std::vector<DeliveryProduct>& products, const fs::path& folder) {
  std::string page = "# Survey\n\n" + dates_of(map);
  page += coordinates.empty()
              ? "Coordinates are those of the map, m: its origin is where the survey began, z is "
                "up. The map has no place on the Earth.\n"
              : "Coordinates: " + coordinates + ", m.\n";
  page += "\n| file | size | what it is |\n|---|---|---|\n";
  for (const DeliveryProduct& product : products) {
    std::error_code error;
    const auto bytes = fs::file_size(folder / product.file, error);
    page += fmt::format("| `{}` | {} | {} |\n", product.file, error ? "" : size_text(bytes),
                        product.about);
  }
  page += fmt::format("\nMade by adit {} of a map of {} keyframes in {} session{}.\n", version(),
                      map.keyframes().size(), map.sessions().size(),
                      map.sessions().size() == 1 ? "" : "s");
  return page;
}

}  // namespace adit
