// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/fleet/shard_standing.hpp"

#include <algorithm>
#include <array>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#include "adit/tools/fleet/fleet_stages.hpp"
#include "adit/tools/fleet/shard_ledger.hpp"
#include "adit/tools/support/commit.hpp"
#include "adit/tools/support/fingerprint.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

std::string key_of(const FleetPlan& plan, const Shard& shard, const std::string& before) {
  std::string made_of =
      fmt::format("{} {} {} {}", version(), commit(), shard.id, shard.input_hash) + before;
  switch (shard.stage) {
    case FleetStage::map:
    case FleetStage::product:
      // Recordings may lie anywhere: what they hold is in `input_hash`.
      for (const std::string& word : shard.words) {
        const bool is_input = std::ranges::count(shard.inputs, fs::path(word)) > 0;
        made_of += is_input ? " {input}" : " " + word;
      }
      break;
    case FleetStage::pairs:
      made_of += fmt::format(" of {}{}", plan.of(FleetStage::pairs).size(),
                             plan.same_site ? " same site" : "");
      break;
    case FleetStage::index:
    case FleetStage::solve:
    case FleetStage::report:
      break;
  }
  if (shard.stage == FleetStage::product || shard.stage == FleetStage::report) {
    for (const DeliveryProduct& product : plan.products) {
      const bool is_its_own = shard.result.filename() == product.file;
      made_of += is_its_own || shard.stage == FleetStage::report ? preset_text(product) : "";
    }
  }
  return text_hash(made_of);
}

bool has_result(const FleetPlan& plan, const Shard& shard, const ShardResult& result) {
  std::error_code error;
  switch (shard.stage) {
    case FleetStage::map:
    case FleetStage::solve:
      return fs::exists(plan.folder / shard.result / "map.adit", error);
    case FleetStage::product:
      return !result.reason.empty() ||
             !product_files(plan, shard, plan.folder / "delivery").empty();
    case FleetStage::pairs:
      return has_ties(plan, shard);
    case FleetStage::index:
    case FleetStage::report:
      break;
  }
  return fs::exists(plan.folder / shard.result, error);
}

/// What later stages have of it.
struct Known {
  ShardState state = ShardState::waiting;
  std::string hash{};
};

Known known(const FleetPlan& plan, const ShardLedger& ledger, const Shard& shard,
            const std::string& key) {
  if (const auto done = ledger.done(shard.id);
      done && done->key == key && has_result(plan, shard, *done)) {
    return {.state = ShardState::done, .hash = done->hash};
  }
  if (const auto failed = ledger.failed(shard.id); failed && failed->key == key) {
    return {.state = ShardState::failed, .hash = "failed"};
  }
  const std::vector<ShardStart> starts = ledger.starts(shard.id);
  const bool runs = !starts.empty() && starts.back().key == key && !starts.back().ended;
  return {.state = runs ? ShardState::running : ShardState::waiting};
}

}  // namespace

std::string_view to_string(ShardState state) {
  constexpr std::array<std::string_view, 4> kNames = {"waiting", "running", "done", "failed"};
  return kNames[static_cast<std::size_t>(state)];
}

bool is_settled(FleetStage stage, ShardState state) {
  return state == ShardState::done || (state == ShardState::failed &&
                                       (stage == FleetStage::map || stage == FleetStage::product));
}

std::vector<ShardStanding> standings_of(const FleetPlan& plan, FleetStage last) {
  const ShardLedger ledger(plan.folder);
  std::vector<ShardStanding> standings;
  bool settled = true;   // the stages before
  std::string earlier;   // their results
  std::string before;    // those of the last one
  std::string of_stage;  // those of the present one
  for (const Shard& shard : plan.shards) {
    if (shard.stage > last) {
      break;
    }
    if (shard.number == 0 && shard.stage != FleetStage::map) {
      for (std::size_t i = 0; i < standings.size(); ++i) {
        settled = settled && is_settled(plan.shards[i].stage, standings[i].state);
      }
      before = std::exchange(of_stage, {});
      earlier += before;
    }
    ShardStanding standing;
    if (settled) {
      // Products are of the map of all, whatever that was made of.
      const bool of_last = shard.stage == FleetStage::product || shard.stage == FleetStage::pairs;
      standing.key = key_of(plan, shard, of_last ? before : earlier);
      const Known shard_known = known(plan, ledger, shard, *standing.key);
      standing.state = shard_known.state;
      of_stage += shard.id + " " + shard_known.hash + "\n";
    }
    standings.push_back(standing);
  }
  return standings;
}

ShardStanding standing_of(const FleetPlan& plan, const Shard& shard) {
  if (shard.stage == FleetStage::map) {
    const std::string key = key_of(plan, shard, "");
    return {.key = key, .state = known(plan, ShardLedger(plan.folder), shard, key).state};
  }
  const auto place = std::ranges::find(plan.shards, shard.id, &Shard::id) - plan.shards.begin();
  return standings_of(plan, shard.stage).at(static_cast<std::size_t>(place));
}

std::optional<std::size_t> missing_for(const FleetPlan& plan, const Shard& shard,
                                       std::span<const ShardStanding> standings) {
  for (std::size_t i = 0; i < standings.size(); ++i) {
    const FleetStage stage = plan.shards[i].stage;
    if (stage < shard.stage && !is_settled(stage, standings[i].state)) {
      return i;
    }
  }
  return std::nullopt;
}

std::vector<fs::path> product_files(const FleetPlan& plan, const Shard& shard,
                                    const fs::path& folder) {
  const std::string name = shard.result.filename().string();
  std::vector<fs::path> files = files_of_product({.file = name}, folder);
  std::erase_if(files, [&](const fs::path& file) {  // cloud_5.laz is no part of cloud.laz
    return file.filename() != name &&
           std::ranges::count(plan.products, file.filename().string(), &DeliveryProduct::file) > 0;
  });
  return files;
}

}  // namespace adit
