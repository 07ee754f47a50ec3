// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What shards do that no other command does. Each writes its results into a folder of its own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adit/tools/fleet/fleet_plan.hpp"
#include "adit/tools/fleet/map_places.hpp"
#include "adit/tools/setup/device_session.hpp"

namespace adit {

/// The maps that are there, and which pairs of them are searched: what `index` has found.
struct FleetIndex {
  std::vector<std::string> maps{};    ///< names of recordings whose maps are there
  std::vector<std::string> hashes{};  ///< of the maps
  std::vector<bool> on_earth{};       ///< where each lies is known
  std::vector<std::string> failed{};  ///< names of recordings without a map
  std::vector<MapPair> pairs{};       ///< by their numbers in `maps`
};

/// Throws InputError where the plan has none, or a damaged one.
FleetIndex read_index(const FleetPlan& plan);

/// Both are known to be of one site (MergeSettings::same_site): the fleet's file says so, or their
/// places on the Earth, which lie near each other, leave no other one that looks alike.
bool is_of_one_site(const FleetPlan& plan, const FleetIndex& index, const MapPair& pair);

/// The name of a map's shard without what all have: that of its folder.
std::string map_name(const Shard& shard);
/// Where a map lies, of a plan.
std::filesystem::path map_of(const FleetPlan& plan, const std::string& name);
/// The file of a pair's tie. Its name is a hash of the contents of both maps.
std::filesystem::path tie_of(const FleetPlan& plan, const FleetIndex& index, const MapPair& pair);

/// Writes INTO/pairs.json.
void index_maps(const FleetPlan& plan, const std::filesystem::path& into);

/// Searches the shard's share of the pairs. A tie is in the plan's folder as soon as it is found,
/// so that a shard which begins again goes on. Writes INTO/pairs.txt, a line a pair.
void search_pairs(const FleetPlan& plan, const Shard& shard, const DeviceOptions& device,
                  const std::filesystem::path& into);

/// All ties that a shard of pairs has found are there still.
bool has_ties(const FleetPlan& plan, const Shard& shard);

/// Writes INTO/map.adit, and INTO/merge.json and merge.txt, which say what was tied and what was
/// not. Throws InputError where no map is tied to another.
void solve_fleet(const FleetPlan& plan, const std::filesystem::path& into);

/// Writes INTO/report.md, and INTO/README.md of the delivery.
void report_fleet(const FleetPlan& plan, const std::filesystem::path& into);

/// Removes from the delivery what is of no product of the plan any more, or of one that has failed.
void remove_stale_products(const FleetPlan& plan);

}  // namespace adit
