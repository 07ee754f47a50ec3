// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/fleet/fleet_status.hpp"

#include <algorithm>
#include <array>
#include <csignal>
#include <map>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "adit/tools/fleet/shard_run.hpp"
#include "adit/tools/fleet/shared_files.hpp"

namespace adit {
namespace {

using Json = nlohmann::ordered_json;

/// A shard with all that its records say.
struct KnownShard {
  const Shard* shard = nullptr;
  ShardState state = ShardState::waiting;
  ShardResult result{};  ///< of a shard that is done or has failed
  std::vector<ShardStart> starts{};
};

std::vector<KnownShard> known_shards(const FleetPlan& plan) {
  const ShardLedger ledger(plan.folder);
  const std::vector<ShardStanding> standings = standings_of(plan, FleetStage::report);
  std::vector<KnownShard> known;
  for (std::size_t i = 0; i < plan.shards.size(); ++i) {
    const Shard& shard = plan.shards[i];
    const ShardState state = standings[i].state;
    known.push_back({.shard = &shard,
                     .state = state,
                     .result = state == ShardState::done     ? ledger.done(shard.id).value()
                               : state == ShardState::failed ? ledger.failed(shard.id).value()
                                                             : ShardResult{},
                     .starts = ledger.starts(shard.id)});
  }
  return known;
}

struct StageSum {
  std::array<std::size_t, 4> states{};  ///< shards by state
  std::size_t starts = 0;
  double seconds = 0.0;  ///< of those that are done
  uint64_t memory = 0;   ///< bytes, the most that one of them took

  std::size_t of(ShardState state) const { return states[static_cast<std::size_t>(state)]; }
};

std::map<FleetStage, StageSum> sums_of(const std::vector<KnownShard>& shards) {
  std::map<FleetStage, StageSum> sums;
  for (const KnownShard& one : shards) {
    StageSum& sum = sums[one.shard->stage];
    ++sum.states[static_cast<std::size_t>(one.state)];
    sum.starts += one.starts.size();
    if (one.state == ShardState::done) {
      sum.seconds += one.result.seconds;
      sum.memory = std::max(sum.memory, one.result.peak_memory);
    }
  }
  return sums;
}

}  // namespace

std::string describe_fleet(const FleetPlan& plan) {
  const std::vector<KnownShard> shards = known_shards(plan);
  const ShardLedger ledger(plan.folder);
  std::string text =
      "stage    shards   done  running  waiting  failed  starts       time  peak memory\n";
  for (const auto& [stage, sum] : sums_of(shards)) {
    text +=
        fmt::format("{:8} {:6} {:6} {:8} {:8} {:7} {:7} {:8.1f} s {:9.0f} MB\n", to_string(stage),
                    plan.of(stage).size(), sum.of(ShardState::done), sum.of(ShardState::running),
                    sum.of(ShardState::waiting), sum.of(ShardState::failed), sum.starts,
                    sum.seconds, static_cast<double>(sum.memory) / 1e6);
  }
  for (const KnownShard& one : shards) {
    const std::string& id = one.shard->id;
    if (one.state == ShardState::failed) {
      text += fmt::format("failed   {}: {}\n         log {}\n", id, one.result.reason,
                          ledger.log(id).string());
    } else if (one.state == ShardState::running) {
      const ShardStart& start = one.starts.back();
      text += fmt::format("running  {} on {}, process {}{}\n", id, start.host, start.process,
                          start.host != host_name()            ? ", or it was killed there"
                          : kill(pid_t(start.process), 0) == 0 ? ""
                                                               : ": it was killed");
    }
  }
  return text;
}

std::string fleet_json(const FleetPlan& plan) {
  Json json;
  json["schema"] = "fleet/1";
  json["folder"] = plan.folder.string();
  json["shards"] = Json::array();
  for (const KnownShard& one : known_shards(plan)) {
    Json shard;
    shard["id"] = one.shard->id;
    shard["stage"] = to_string(one.shard->stage);
    shard["state"] = to_string(one.state);
    shard["starts"] = one.starts.size();
    shard["expected_seconds"] = one.shard->seconds;
    shard["expected_memory"] = one.shard->memory;
    if (one.state == ShardState::done || one.state == ShardState::failed) {
      shard["host"] = one.result.host;
      shard["reason"] = one.result.reason;
      shard["seconds"] = one.result.seconds;
      shard["processor_seconds"] = one.result.processor_seconds;
      shard["peak_memory"] = one.result.peak_memory;
      shard["hash"] = one.result.hash;
    }
    json["shards"].push_back(std::move(shard));
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace adit
