// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/slam/core/text.hpp"
#include "adit/tools/fleet/fleet_stages.hpp"
#include "adit/tools/fleet/shard_ledger.hpp"
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

/// Names of maps in a list of merge.json, with what it says there.
std::map<std::string, std::string> named_in(const Json& merge, const char* list, const char* file,
                                            const char* what) {
  std::map<std::string, std::string> named;
  if (!merge.is_object() || !merge.contains(list)) {
    return named;
  }
  for (const Json& one : merge.at(list)) {
    const std::string name = fs::path(one.value(file, "")).parent_path().filename().string();
    named[name] = one.contains(what) ? one.at(what).dump() : "";
  }
  return named;
}

std::string in_map(const Json& merge, const std::string& name) {
  const auto sessions = named_in(merge, "sessions", "from", "id");
  if (const auto session = sessions.find(name); session != sessions.end()) {
    return "session " + session->second;
  }
  const auto apart = named_in(merge, "apart", "map", "reason");
  const auto reason = apart.find(name);
  return reason == apart.end()
             ? "no"
             : "no: " + Json::parse(reason->second, nullptr, false).get<std::string>();
}

std::string recordings_table(const FleetPlan& plan, const ShardLedger& ledger, const Json& merge) {
  std::string text =
      "| recording | keyframes | path, m | verdict of its run | in the map of all |\n"
      "|---|---|---|---|---|\n";
  for (const Shard& shard : plan.of(FleetStage::map)) {
    const std::string name = map_name(shard);
    if (!ledger.done(shard.id)) {
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

std::string products_table(const FleetPlan& plan, const ShardLedger& ledger) {
  std::string text;
  for (const Shard& shard : plan.of(FleetStage::product)) {
    const std::optional<ShardResult> done = ledger.done(shard.id);
    const std::optional<ShardResult> failed = ledger.failed(shard.id);
    text += fmt::format("- `{}`{}\n", shard.result.string(),
                        !done                   ? ": failed: " + (failed ? failed->reason : "")
                        : !done->reason.empty() ? ": " + done->reason
                                                : "");
  }
  return text;
}

std::vector<DeliveryProduct> products_there(const FleetPlan& plan) {
  std::vector<DeliveryProduct> there;
  for (const DeliveryProduct& product : plan.products) {
    if (!files_of_product(product, plan.folder / "delivery").empty()) {
      there.push_back(product);
    }
  }
  return there;
}

}  // namespace

void report_fleet(const FleetPlan& plan, const fs::path& into) {
  const ShardLedger ledger(plan.folder);
  const fs::path merged = plan.folder / "site";
  const Json merge = read_json(merged / "merge.json");
  std::string text = "# Fleet\n\n" + recordings_table(plan, ledger, merge);
  text += "\n## The map of all\n\n```text\n" + read_text_file(merged / "merge.txt") + "```\n";
  text += "\n## Products\n\n" + products_table(plan, ledger);
  write_text_file(into / "report.md", text);
  const fs::path copy = into / "map.adit";
  fs::copy_file(merged / "map.adit", copy, fs::copy_options::overwrite_existing);
  {
    const MapDatabase map(copy, MapAccess::read);
    DeliveryPlace place = plan.place;
    place.on_earth = place.origin || map.georeference();
    write_text_file(into / "README.md",
                    delivery_page(map, delivery_system(map, place), products_there(plan),
                                  plan.folder / "delivery"));
  }
  fs::remove(copy);
}

}  // namespace adit
