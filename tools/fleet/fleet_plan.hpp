// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A fleet's work as shards: each is one command on one machine, and says what it needs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/fleet/fleet_file.hpp"

namespace adit {

/// The stages in their order. Shards of one stage need nothing of each other.
enum class FleetStage {
  map,      ///< each recording by itself
  index,    ///< which pairs of maps may have a place in common
  pairs,    ///< the search for one map of a pair in the other
  solve,    ///< one map of all
  product,  ///< a file of the delivery each
  report,   ///< what became of each recording
};
/// All of them, in order.
inline constexpr std::array kFleetStages = {FleetStage::map,     FleetStage::index,
                                            FleetStage::pairs,   FleetStage::solve,
                                            FleetStage::product, FleetStage::report};
/// The enumerator's name.
std::string_view to_string(FleetStage stage);
/// Nothing: there is no such stage.
std::optional<FleetStage> stage_named(std::string_view name);

/// A piece of a fleet's work.
struct Shard {
  std::string id{};  ///< unique, a file's name: "map-drive_7"
  FleetStage stage = FleetStage::map;
  std::size_t number = 0;  ///< within its stage, from 0
  /// Of `adit`. "{out}" is a folder for what it makes, "{map}" a copy of the map of all, "{plan}"
  /// the plan's folder.
  std::vector<std::string> words{};
  std::vector<std::filesystem::path>
      inputs{};                    ///< files and folders that it reads, but for results
  std::filesystem::path result{};  ///< what it makes, in the plan's folder
  std::string input_hash{};        ///< of the inputs, as they were planned
  uint64_t input_bytes = 0;        ///< their size
  uint64_t memory = 0;             ///< bytes that it will take, about
  double seconds = 0.0;            ///< that it will take, about
};

/// A plan's folder, read.
struct FleetPlan {
  std::filesystem::path folder{};        ///< absolute
  std::filesystem::path fleet_folder{};  ///< that the shards work in
  bool same_site = false;
  std::vector<DeliveryProduct> products{};
  DeliveryPlace place{};
  std::vector<Shard> shards{};  ///< stage by stage

  /// The shards of a stage, in order.
  std::span<const Shard> of(FleetStage stage) const;
};

/// The shards of a fleet, in a plan's folder that need not exist. Names of maps that an earlier
/// plan of that folder has given stay. Throws InputError: two recordings are the same.
FleetPlan plan_fleet(const Fleet& fleet, const std::filesystem::path& folder);

/// Writes the plan: plan.json and shards.jsonl, and the presets of its products. Throws
/// OutputError.
void write_plan(const FleetPlan& plan);

/// Throws InputError where the folder holds no plan, or a damaged one.
FleetPlan read_plan(const std::filesystem::path& folder);

/// TOML that parse_delivery() reads.
std::string preset_text(const DeliveryProduct& product);

/// The folder holds a plan.
bool has_plan(const std::filesystem::path& folder);

}  // namespace adit
