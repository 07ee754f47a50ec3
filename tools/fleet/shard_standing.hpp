// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Where the shards of a plan stand, by their records and their results.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/fleet/fleet_plan.hpp"

namespace adit {

/// Where a shard stands.
enum class ShardState {
  waiting,  ///< for earlier stages, or for a machine
  running,  ///< it was begun and has not ended, or was killed
  done,     ///< and its result is there
  failed,
};
/// The enumerator's name.
std::string_view to_string(ShardState state);

/// A shard by its records.
struct ShardStanding {
  /// What it is made of: adit's version, its command, its inputs, and the results of the stages
  /// before; nothing: one of these is not settled.
  std::optional<std::string> key{};
  ShardState state = ShardState::waiting;
};

/// A recording without a map and a product that could not be written are results, too: the other
/// shards go on.
bool is_settled(FleetStage stage, ShardState state);

/// The shards of the stages up to `last`, in the plan's order. Each record is read once.
std::vector<ShardStanding> standings_of(const FleetPlan& plan, FleetStage last);

/// One shard. That of a map asks for no other.
ShardStanding standing_of(const FleetPlan& plan, const Shard& shard);

/// The first shard of an earlier stage that is not settled, by its place in the plan.
std::optional<std::size_t> missing_for(const FleetPlan& plan, const Shard& shard,
                                       std::span<const ShardStanding> standings);

/// The files of a product in the plan's delivery, or in a folder that its shard has written.
std::vector<std::filesystem::path> product_files(const FleetPlan& plan, const Shard& shard,
                                                 const std::filesystem::path& folder);

}  // namespace adit
