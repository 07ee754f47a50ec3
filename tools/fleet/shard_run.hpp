// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Runs shards: any number of machines, in any order that the stages allow, as often as one likes.
#pragma once

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "adit/tools/fleet/fleet_plan.hpp"
#include "adit/tools/fleet/shard_ledger.hpp"
#include "adit/tools/fleet/shard_standing.hpp"

namespace adit {

/// Exit codes of `adit shard`.
inline constexpr int kShardDone = 0;
inline constexpr int kShardFailed = 1;
inline constexpr int kShardAgain = 75;  ///< EX_TEMPFAIL: it was not the shard's fault

/// A shard is killed on one machine at most so many times: then it has failed (no memory, say).
inline constexpr std::size_t kMostKills = 3;

/// What runs shards.
struct ShardProgram {
  std::filesystem::path program{};  ///< adit
  std::vector<std::string>
      device_words{};  ///< options of the device, for the shards that take them
};

/// Runs a shard of the plan in a process of its own and keeps its result and its record in the
/// plan's folder. One that is done with the same key is left as it is. Returns one of the exit
/// codes above, or 128 and the number of the signal that stopped it. Throws nothing but what
/// memory does: a disk that is full is said, and to be tried again.
int run_shard(const FleetPlan& plan, const Shard& shard, const ShardProgram& program,
              std::ostream& out, std::ostream& err);

}  // namespace adit
