// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/fleet/fleet_plan.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/tools/fleet/shard_estimate.hpp"
#include "adit/tools/support/fingerprint.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/output_file.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kPlanFile = "plan.json";
constexpr const char* kShardsFile = "shards.jsonl";
constexpr const char* kPlanRemedy = "Make the plan again: adit plan FLEET.toml -o PLAN";

std::string text_of(const std::optional<std::string>& text) {
  return text.value_or("");
}
std::optional<std::string> given(const std::string& text) {
  return text.empty() ? std::nullopt : std::optional(text);
}

/// Names for all recordings: those of the earlier plan stay, others get the lowest number that is
/// free.
std::vector<std::string> names_of(const Fleet& fleet, const std::optional<FleetPlan>& earlier) {
  std::map<fs::path, std::string> known;
  if (earlier) {
    for (const Shard& shard : earlier->of(FleetStage::map)) {
      known[shard.inputs.front()] = shard.result.filename().string();
    }
  }
  std::set<std::string> taken;
  for (const FleetRecording& recording : fleet.recordings) {
    if (recording.is_named) {
      known[recording.parts.front()] = recording.name;
    }
    if (const auto name = known.find(recording.parts.front()); name != known.end()) {
      taken.insert(name->second);
    }
  }
  std::vector<std::string> names;
  for (const FleetRecording& recording : fleet.recordings) {
    if (const auto name = known.find(recording.parts.front()); name != known.end()) {
      names.push_back(name->second);
      continue;
    }
    std::string name = recording.name;
    for (int number = 2; !taken.insert(name).second; ++number) {
      name = fmt::format("{}-{}", recording.name, number);
    }
    names.push_back(std::move(name));
  }
  return names;
}

/// Files and folders that the options name.
std::vector<fs::path> files_in(const std::vector<std::string>& options, const fs::path& folder) {
  std::vector<fs::path> files;
  for (const std::string& option : options) {
    std::error_code error;
    // "--config=robot.toml", too.
    const std::size_t value = option.starts_with('-') ? option.find('=') : std::string::npos;
    const std::string word = value == std::string::npos ? option : option.substr(value + 1);
    if (!word.empty() && !word.starts_with('-') && fs::exists(folder / word, error)) {
      files.push_back((folder / word).lexically_normal());
    }
  }
  return files;
}

Shard map_shard(const FleetRecording& recording, const std::string& name, const fs::path& folder) {
  Shard shard{.id = "map-" + name, .stage = FleetStage::map, .result = fs::path("maps") / name};
  shard.words = {"run"};
  for (const fs::path& part : recording.parts) {
    shard.words.push_back(part.string());
    shard.inputs.push_back(part);
  }
  shard.words.insert(shard.words.end(), {"-o", "{out}"});
  shard.words.insert(shard.words.end(), recording.options.begin(), recording.options.end());
  std::ranges::move(files_in(recording.options, folder), std::back_inserter(shard.inputs));
  const Fingerprint inputs = fingerprint(shard.inputs);
  shard.input_hash = inputs.hash;
  shard.input_bytes = inputs.bytes;
  return shard;
}

fs::path preset_of(const fs::path& folder, const DeliveryProduct& product) {
  return folder / "products" / (product.file + ".toml");
}

/// Absolute, without a slash at its end.
fs::path folder_of(const fs::path& folder) {
  const fs::path whole = fs::absolute(folder).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

Shard product_shard(const DeliveryProduct& product, const FleetPlan& plan) {
  Shard shard{.id = "product-" + product.file,
              .stage = FleetStage::product,
              .result = fs::path("delivery") / product.file};
  shard.words = {"deliver", "{map}",    "-o",
                 "{out}",   "--preset", preset_of("{plan}", product).string()};
  const auto add = [&](const char* option, const std::optional<std::string>& value) {
    if (value) {
      shard.words.insert(shard.words.end(), {option, *value});
    }
  };
  add("--origin", plan.place.origin);
  add("--crs", plan.place.crs);
  if (plan.place.geoid) {
    add("--geoid", plan.place.geoid->string());
    shard.inputs.push_back(*plan.place.geoid);
    shard.input_hash = fingerprint(shard.inputs).hash;
  }
  return shard;
}

}  // namespace

// JSON's texts are TOML's, too.
std::string preset_text(const DeliveryProduct& product) {
  std::string options;
  for (const std::string& word : product.options) {
    options += (options.empty() ? "" : " ") + word;
  }
  std::string text = "[[product]]\nfile = " + Json(product.file).dump() +
                     "\nexport = " + Json(options).dump() +
                     "\nabout = " + Json(product.about).dump() + "\n";
  const char* const needs = product.needs_place       ? "place"
                            : product.needs_recording ? "recording"
                            : product.needs_cameras   ? "cameras"
                            : product.optional        ? "content"
                                                      : nullptr;
  return needs == nullptr ? text : text + "needs = \"" + needs + "\"\n";
}

namespace {

void require_other_recordings(const Fleet& fleet) {
  std::map<std::string, fs::path> seen;
  for (const FleetRecording& recording : fleet.recordings) {
    const auto [there, is_new] =
        seen.try_emplace(fingerprint(recording.parts).hash, recording.parts.front());
    if (!is_new) {
      throw InputError(recording.parts.front(), {},
                       "it holds the same as " + there->second.string(),
                       "A recording counts once: leave one of the two out");
    }
  }
}

Json shard_json(const Shard& shard) {
  Json json;
  json["id"] = shard.id;
  json["stage"] = to_string(shard.stage);
  json["number"] = shard.number;
  json["command"] = shard.words;
  json["inputs"] = Json::array();
  for (const fs::path& input : shard.inputs) {
    json["inputs"].push_back(input.string());
  }
  json["result"] = shard.result.string();
  json["input_hash"] = shard.input_hash;
  json["input_bytes"] = shard.input_bytes;
  json["memory"] = shard.memory;
  json["seconds"] = shard.seconds;
  return json;
}

Shard shard_of(const Json& json, const fs::path& file) {
  const auto stage = stage_named(json.at("stage").get<std::string>());
  if (!stage) {
    throw InputError(file, {}, "it has an unknown stage", kPlanRemedy);
  }
  Shard shard{.id = json.at("id").get<std::string>(),
              .stage = *stage,
              .number = json.at("number").get<std::size_t>(),
              .words = json.at("command").get<std::vector<std::string>>(),
              .result = json.at("result").get<std::string>(),
              .input_hash = json.at("input_hash").get<std::string>(),
              .input_bytes = json.at("input_bytes").get<uint64_t>(),
              .memory = json.at("memory").get<uint64_t>(),
              .seconds = json.at("seconds").get<double>()};
  for (const Json& input : json.at("inputs")) {
    shard.inputs.emplace_back(input.get<std::string>());
  }
  const fs::path name(shard.id);
  if (shard.id.empty() || name.filename() != name || shard.result.is_absolute()) {
    throw InputError(file, {}, "'" + shard.id + "' is no shard", kPlanRemedy);
  }
  return shard;
}

std::vector<Shard> read_shards(const fs::path& file) {
  const std::string text = read_text_file(file);
  LineReader lines(text);
  std::vector<Shard> shards;
  while (const auto line = lines.next()) {
    if (!line->empty()) {
      shards.push_back(shard_of(Json::parse(*line), file));
    }
  }
  return shards;
}

}  // namespace

std::string_view to_string(FleetStage stage) {
  constexpr std::array<std::string_view, kFleetStages.size()> kNames = {
      "map", "index", "pairs", "solve", "product", "report"};
  return kNames[static_cast<std::size_t>(stage)];
}

std::optional<FleetStage> stage_named(std::string_view name) {
  const auto found =
      std::ranges::find(kFleetStages, name, [](FleetStage one) { return to_string(one); });
  return found == kFleetStages.end() ? std::nullopt : std::optional(*found);
}

std::span<const Shard> FleetPlan::of(FleetStage stage) const {
  const auto [begin, end] = std::ranges::equal_range(shards, stage, {}, &Shard::stage);
  return {begin, end};
}

FleetPlan plan_fleet(const Fleet& fleet, const fs::path& folder) {
  require_other_recordings(fleet);
  const std::optional<FleetPlan> earlier =
      has_plan(folder) ? std::optional(read_plan(folder)) : std::nullopt;
  FleetPlan plan{.folder = folder_of(folder),
                 .fleet_folder = fleet.folder,
                 .same_site = fleet.same_site,
                 .products = fleet.products,
                 .place = fleet.place};
  const std::vector<std::string> names = names_of(fleet, earlier);
  for (std::size_t i = 0; i < names.size(); ++i) {
    plan.shards.push_back(map_shard(fleet.recordings[i], names[i], fleet.folder));
  }
  const auto inside = [&](const std::string& id) {
    return std::vector<std::string>{"shard", "{plan}", id, "--into", "{out}"};
  };
  plan.shards.push_back({.id = "index",
                         .stage = FleetStage::index,
                         .words = inside("index"),
                         .result = "index/pairs.json"});
  const std::size_t most_pairs = names.size() * (names.size() - 1) / 2;
  for (std::size_t k = 0; k < std::min(fleet.pair_shards, most_pairs); ++k) {
    const std::string id = fmt::format("pairs-{}", k);
    plan.shards.push_back({.id = id,
                           .stage = FleetStage::pairs,
                           .words = inside(id),
                           .result = fs::path("pairs") / (id + ".txt")});
  }
  plan.shards.push_back(
      {.id = "solve", .stage = FleetStage::solve, .words = inside("solve"), .result = "site"});
  for (const DeliveryProduct& product : fleet.products) {
    plan.shards.push_back(product_shard(product, plan));
  }
  plan.shards.push_back({.id = "report",
                         .stage = FleetStage::report,
                         .words = inside("report"),
                         .result = "report.md"});
  std::map<FleetStage, std::size_t> numbers;
  for (Shard& shard : plan.shards) {
    shard.number = numbers[shard.stage]++;
  }
  plan.shards = estimated(plan);
  return plan;
}

void write_plan(const FleetPlan& plan) {
  std::error_code error;
  fs::create_directories(plan.folder / "products", error);
  if (error) {
    throw OutputError(
        plan.folder, plan.folder.string() + ": cannot be made a folder. Name another one with -o.");
  }
  Json json;
  json["adit"] = version();
  json["fleet_folder"] = plan.fleet_folder.string();
  json["same_site"] = plan.same_site;
  json["products"] = Json::array();
  for (const DeliveryProduct& product : plan.products) {
    json["products"].push_back(product.file);
    replace_text_file(preset_of(plan.folder, product), preset_text(product));
  }
  json["origin"] = text_of(plan.place.origin);
  json["crs"] = text_of(plan.place.crs);
  json["geoid"] = plan.place.geoid ? plan.place.geoid->string() : "";
  std::string shards;
  for (const Shard& shard : plan.shards) {
    shards += shard_json(shard).dump() + "\n";
  }
  replace_text_file(plan.folder / kShardsFile, shards);
  replace_text_file(plan.folder / kPlanFile, json.dump(2) + "\n");
}

FleetPlan read_plan(const fs::path& folder) {
  const fs::path file = folder / kPlanFile;
  if (!has_plan(folder)) {
    throw InputError(folder, {}, "it is no plan's folder", kPlanRemedy);
  }
  try {
    const Json json = Json::parse(read_text_file(file));
    FleetPlan plan{.folder = folder_of(folder),
                   .fleet_folder = json.at("fleet_folder").get<std::string>(),
                   .same_site = json.at("same_site").get<bool>(),
                   .place = {.origin = given(json.at("origin").get<std::string>()),
                             .crs = given(json.at("crs").get<std::string>()),
                             .geoid = given(json.at("geoid").get<std::string>())}};
    for (const Json& product : json.at("products")) {
      const fs::path preset = preset_of(folder, {.file = product.get<std::string>()});
      plan.products.push_back(parse_delivery(read_text_file(preset), preset).front());
    }
    plan.shards = read_shards(folder / kShardsFile);
    if (!std::ranges::is_sorted(plan.shards, {}, &Shard::stage) ||
        plan.of(FleetStage::product).size() != plan.products.size()) {
      throw InputError(folder / kShardsFile, {},
                       "its stages are not in order, or it is being written", kPlanRemedy);
    }
    return plan;
  } catch (const Json::exception& error) {
    throw InputError(file, {}, std::string("it is no plan: ") + error.what(), kPlanRemedy);
  }
}

bool has_plan(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / kPlanFile, error);
}

}  // namespace adit
