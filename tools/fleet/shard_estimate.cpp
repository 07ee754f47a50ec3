// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/fleet/shard_estimate.hpp"

#include <algorithm>
#include <optional>

#include "adit/slam/core/median.hpp"
#include "adit/tools/fleet/shard_ledger.hpp"

namespace adit {
namespace {

/// What a shard takes, by the bytes of the recordings that it is about.
struct Cost {
  double seconds = 0.0;  ///< whatever the recording
  double seconds_per_byte = 0.0;
  double memory = 0.0;  ///< bytes, whatever the recording
  double memory_per_byte = 0.0;
};

// About what was measured on two processor cores without a GPU (decision 0047): of recordings of
// 170 MB a map took 7 s and 250 MB, a pair 7 s and 200 MB; of eleven of them the map of all 4 s and
// 70 MB, a product 7 s and 170 MB.
Cost usual_cost(FleetStage stage) {
  switch (stage) {
    case FleetStage::map:
      return {.seconds = 3.0, .seconds_per_byte = 2.5e-8, .memory = 150e6, .memory_per_byte = 0.6};
    case FleetStage::pairs:
      return {.seconds = 3.0, .seconds_per_byte = 1e-7, .memory = 150e6, .memory_per_byte = 0.3};
    case FleetStage::solve:
      return {.seconds = 1.0, .seconds_per_byte = 2e-9, .memory = 40e6, .memory_per_byte = 0.03};
    case FleetStage::product:
      return {.seconds = 1.0, .seconds_per_byte = 4e-9, .memory = 80e6, .memory_per_byte = 0.05};
    case FleetStage::index:
    case FleetStage::report:
      break;
  }
  return {.seconds = 1.0, .seconds_per_byte = 1e-10, .memory = 30e6, .memory_per_byte = 0.001};
}

double bytes_of(const FleetPlan& plan, const Shard& shard, double all) {
  switch (shard.stage) {
    case FleetStage::map:
      return static_cast<double>(shard.input_bytes);
    case FleetStage::pairs:
      return all / static_cast<double>(plan.of(FleetStage::pairs).size());
    case FleetStage::index:
    case FleetStage::solve:
    case FleetStage::product:
    case FleetStage::report:
      break;
  }
  return all;
}

/// What done shards of a stage took beside what was expected of them.
struct Factors {
  double seconds = 1.0;
  double memory = 1.0;
};

}  // namespace

std::vector<Shard> estimated(const FleetPlan& plan) {
  double all = 0.0;
  for (const Shard& shard : plan.of(FleetStage::map)) {
    all += static_cast<double>(shard.input_bytes);
  }
  const ShardLedger ledger(plan.folder);
  std::vector<Shard> shards = plan.shards;
  for (const FleetStage stage : kFleetStages) {
    std::vector<double> seconds;
    std::vector<double> memory;
    for (Shard& shard : shards) {
      if (shard.stage != stage) {
        continue;
      }
      const Cost cost = usual_cost(shard.stage);
      const double bytes = bytes_of(plan, shard, all);
      shard.seconds = cost.seconds + cost.seconds_per_byte * bytes;
      shard.memory = static_cast<uint64_t>(cost.memory + cost.memory_per_byte * bytes);
      if (const auto done = ledger.done(shard.id)) {
        seconds.push_back(done->seconds / shard.seconds);
        memory.push_back(static_cast<double>(done->peak_memory) /
                         static_cast<double>(shard.memory));
      }
    }
    const Factors factors = seconds.empty() ? Factors{}
                                            : Factors{.seconds = median(std::move(seconds)),
                                                      .memory = median(std::move(memory))};
    for (Shard& shard : shards) {
      if (shard.stage == stage) {
        shard.seconds *= factors.seconds;
        shard.memory = static_cast<uint64_t>(static_cast<double>(shard.memory) * factors.memory);
      }
    }
  }
  return shards;
}

}  // namespace adit
