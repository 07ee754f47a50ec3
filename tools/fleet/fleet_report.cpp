// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/text.hpp"
#include "adit/tools/fleet/fleet_stages.hpp"
#include "adit/tools/fleet/shard_ledger.hpp"
#include "adit/tools/fleet/shard_standing.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/support/input_file.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// What a run or the merge wrote; null where it cannot be read.
Json read_json(const fs::path& file) {
  std::error_code error;
  return fs::exists(file, error) ? Json::parse(read_text_file(file), nullptr, false) : Json();
}

/// A value deep in a JSON text, for people; "-" where there is none.
std::string at(const Json& json, const char* pointer) {
  const Json::json_pointer path(pointer);
  if (!json.is_object() || !json.contains(path)) {
    return "-";
  }
  const Json& value = json.at(path);
  return value.is_string()         ? value.get<std::string>()
         : value.is_number_float() ? with_decimals(value.get<double>(), 1)
                                   : value.dump();
}

/// What a list of merge.json says of a map, whose file is under `file` there; null: nothing.
Json said_of(const Json& merge, const char* list, const char* file, const std::string& name) {
  for (const Json& one : merge.is_object() ? merge.value(list, Json::array()) : Json::array()) {
    if (fs::path(one.value(file, "")).parent_path().filename() == name) {
      return one;
    }
  }
  return {};
}

std::string in_map(const Json& merge, const std::string& name) {
  const Json session = said_of(merge, "sessions", "from", name);
  if (!session.is_null()) {
    return "session " + at(session, "/id");
  }
  const Json apart = said_of(merge, "apart", "map", name);
  return apart.is_null() ? "no" : "no: " + at(apart, "/reason");
}

std::string recordings_table(const FleetPlan& plan, std::span<const ShardStanding> standings,
                             const Json& merge) {
  const ShardLedger ledger(plan.folder);
  std::string text =
      "| recording | keyframes | path, m | verdict of its run | in the map of all |\n"
      "|---|---|---|---|---|\n";
  for (const Shard& shard : plan.of(FleetStage::map)) {
    const std::string name = map_name(shard);
    if (standings[shard.number].state != ShardState::done) {
      const std::optional<ShardResult> failed = ledger.failed(shard.id);
      text += fmt::format("| {} | - | - | failed | no: {} |\n", name,
                          failed ? failed->reason : "it has no result");
      continue;
    }
    const Json summary = read_json(map_of(plan, name).parent_path() / "summary.json");
    text +=
        fmt::format("| {} | {} | {} | {} | {} |\n", name, at(summary, "/map/keyframes"),
                    at(summary, "/distance_m"), at(summary, "/verdict/state"), in_map(merge, name));
  }
  return text;
}

/// Whether each product of the plan is there.
std::vector<bool> products_done(const FleetPlan& plan, std::span<const ShardStanding> standings) {
  std::vector<bool> done;
  for (std::size_t i = 0; i < standings.size(); ++i) {
    if (plan.shards[i].stage == FleetStage::product) {
      done.push_back(standings[i].state == ShardState::done);
    }
  }
  return done;
}

std::string products_table(const FleetPlan& plan, const std::vector<bool>& done) {
  const ShardLedger ledger(plan.folder);
  std::string text;
  for (const Shard& shard : plan.of(FleetStage::product)) {
    const std::optional<ShardResult> result =
        done[shard.number] ? ledger.done(shard.id) : ledger.failed(shard.id);
    const std::string reason = result ? result->reason : "";
    text += fmt::format("- `{}`{}{}\n", shard.result.string(),
                        done[shard.number] ? (reason.empty() ? "" : ": ") : ": failed: ", reason);
  }
  return text;
}

}  // namespace

void report_fleet(const FleetPlan& plan, const fs::path& into) {
  const std::vector<ShardStanding> standings = standings_of(plan, FleetStage::product);
  const std::vector<bool> done = products_done(plan, standings);
  const fs::path merged = plan.folder / "site";
  const Json merge = read_json(merged / "merge.json");
  std::string text = "# Fleet\n\n" + recordings_table(plan, standings, merge);
  text += "\n## The map of all\n\n```text\n" + read_text_file(merged / "merge.txt") + "```\n";
  text += "\n## Products\n\n" + products_table(plan, done);
  write_text_file(into / "report.md", text);
  std::vector<DeliveryProduct> there;
  for (const Shard& shard : plan.of(FleetStage::product)) {
    if (done[shard.number] && !product_files(plan, shard, plan.folder / "delivery").empty()) {
      there.push_back(plan.products[shard.number]);
    }
  }
  const fs::path copy = into / "map.adit";
  fs::copy_file(merged / "map.adit", copy, fs::copy_options::overwrite_existing);
  {
    const MapDatabase map(copy, MapAccess::read);
    DeliveryPlace place = plan.place;
    place.on_earth = place.origin || map.georeference();
    if (!why_no_colors(map, place, into).empty()) {
      std::ranges::transform(there, there.begin(), without_colors);
    }
    write_text_file(into / "README.md", delivery_page(map, delivery_system(map, place), there,
                                                      plan.folder / "delivery"));
  }
  fs::remove(copy);
}

void remove_stale_products(const FleetPlan& plan) {
  constexpr std::string_view kPrefix = "product-";
  const ShardLedger ledger(plan.folder);
  const std::vector<ShardStanding> standings = standings_of(plan, FleetStage::product);
  const std::vector<bool> done = products_done(plan, standings);
  const std::span<const Shard> products = plan.of(FleetStage::product);
  for (const std::string& id : ledger.all_done()) {
    const auto shard = std::ranges::find(products, id, &Shard::id);
    if (!id.starts_with(kPrefix) || (shard != products.end() && done[shard->number])) {
      continue;
    }
    const fs::path name = id.substr(kPrefix.size());
    for (const fs::path& file : product_files(plan, {.result = name}, plan.folder / "delivery")) {
      std::error_code ignored;
      fs::remove(file, ignored);
    }
    ledger.forget(id);
  }
}

}  // namespace adit
