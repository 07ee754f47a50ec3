// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What `adit plan` is given: many recordings that become one map (docs/fleets.md).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adit/tools/export/delivery.hpp"

namespace adit {

/// A recording of a fleet.
struct FleetRecording {
  std::string name{};                          ///< unique, the name of its map's folder
  bool is_named = false;                       ///< by the file
  std::vector<std::filesystem::path> parts{};  ///< absolute; several follow each other in time
  std::vector<std::string> options{};          ///< of `adit run`
};

/// A fleet's file, read.
struct Fleet {
  std::filesystem::path folder{};  ///< of the file: its paths count from there
  /// In the order of the file, those of a pattern by name.
  std::vector<FleetRecording> recordings{};
  bool same_site = false;                   ///< MergeSettings::same_site
  std::size_t pair_shards = 8;              ///< shards that search pairs of maps
  std::vector<DeliveryProduct> products{};  ///< of the map of all
  DeliveryPlace place{};                    ///< of the products
};

/// Throws InputError: no TOML, an unknown key, a pattern that matches nothing, a recording that is
/// named twice.
Fleet read_fleet(const std::filesystem::path& file);

}  // namespace adit
