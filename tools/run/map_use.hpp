// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Runs that use a map of earlier sessions: to be localised in it, or to extend it.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/slam/mapping/map_store.hpp"
#include "adit/slam/mapping/start_place.hpp"
#include "adit/slam/mapping/stored_map.hpp"

namespace adit {

struct RunCommandOptions;

/// How `adit run` and `adit live` are asked to use an earlier map.
struct MapUseOptions {
  std::optional<std::filesystem::path> map;  ///< the file or the folder of a run
  bool localize = false;                     ///< without `extend` it is
  bool extend = false;
  bool keep = false;
  std::vector<double> pose{};  ///< X Y Z YAW: m, degrees; empty: not known
};

/// A map of earlier sessions, and what a run does with it.
struct MapUse {
  std::filesystem::path map;  ///< the file
  bool extends = false;  ///< the session goes into a copy of the map; else the map is only read
  bool keeps = false;    ///< the map's keyframes stay where they are
  std::optional<StartPlace> start{};

  EarlierSessions earlier_sessions() const {
    return keeps ? EarlierSessions::keep : EarlierSessions::move;
  }
};

/// Of an option's four numbers X Y Z YAW (m, degrees). Throws UsageError where one is out of range.
StartPlace start_place(std::string_view option, std::span<const double> numbers);

/// Nothing where no map is named. Throws UsageError where the options do not fit together or to the
/// output, and InputError where there is no such map, or nothing in it.
std::optional<MapUse> map_use(const RunCommandOptions& options, const Config& config);

/// Throws InputError where the session's recording is in the map already.
void require_new_recording(const MapUse& use, const MapSession& session);

}  // namespace adit
