// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Runs shards: any number of machines, in any order that the stages allow, as often as one likes.
#pragma once

#include <filesystem>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/fleet/fleet_plan.hpp"
#include "adit/tools/fleet/shard_ledger.hpp"

namespace adit {

/// Where a shard stands.
enum class ShardState {
  waiting,  ///< for earlier stages, or for a machine
  running,  ///< it was begun and has not ended, or was killed
  done,
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

/// Where the shards of a plan stand, those of the stages up to `last`, in the plan's order. Each
/// record is read once.
std::vector<ShardStanding> standings_of(const FleetPlan& plan, FleetStage last);

/// The first shard of an earlier stage that later ones wait for: it is not done, nor has it failed
/// where the others go on without it. `standings` reach as far as the shard.
std::optional<std::string> missing_for(const FleetPlan& plan, const Shard& shard,
                                       std::span<const ShardStanding> standings);

/// Exit codes of `adit shard`.
inline constexpr int kShardDone = 0;
inline constexpr int kShardFailed = 1;
inline constexpr int kShardAgain = 75;  ///< EX_TEMPFAIL: it was not the shard's fault

/// A shard is begun at most so many times without coming to an end (killed, no memory).
inline constexpr std::size_t kMostStarts = 3;

/// Runs a shard, which is one of the plan's, in a process of its own and keeps its result and its
/// record in the plan's folder. One that is done with the same key is left as it is. Returns one of
/// the exit codes above, or 128 and the number of the signal that stopped it. Throws OutputError
/// where the record cannot be written.
int run_shard(const FleetPlan& plan, const Shard& shard, const std::filesystem::path& program,
              std::ostream& out, std::ostream& err);

}  // namespace adit
