// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Merges maps into a new one (docs/maps.md).
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adit/slam/mapping/map_merge.hpp"
#include "adit/tools/map_database/unfinished_map.hpp"
#include "adit/tools/map_merge/merge_inputs.hpp"
#include "adit/tools/map_merge/tied_maps.hpp"
#include "adit/tools/setup/device_session.hpp"

namespace adit {

struct MergeCommandOptions {
  std::vector<std::filesystem::path> maps{};  ///< files, or folders of runs
  std::filesystem::path output{};
  DeviceOptions device{};
  MergeSettings settings{};
  bool quiet = false;
  bool json = false;
};

/// A session of the merged map.
struct MergedSession {
  SessionId id = 0;
  std::string name{};
  std::filesystem::path from{};  ///< the map that it comes from
  std::size_t keyframes = 0;
  /// m: standard deviation of its keyframes' positions relative to other sessions, along the least
  /// certain axis, the median over its keyframes; none: nothing ties it to another session.
  std::optional<double> sigma{};
};

/// The edges between two sessions.
struct SessionTie {
  SessionId one = 0;
  SessionId other = 0;
  std::size_t edges = 0;
  double metres = 0.0;   ///< median of what the merged map leaves of them
  double radians = 0.0;  ///< the same of their rotations
};

/// A map that is tied to none of the others.
struct MapApart {
  std::filesystem::path file{};
  std::size_t keyframes = 0;
  std::size_t candidates = 0;                    ///< pairs of keyframes that were compared
  std::size_t verified = 0;                      ///< of them: their submaps fit
  std::optional<double> log_odds{};              ///< MergeSearch::log_odds, the best
  std::optional<double> built_alike_log_odds{};  ///< the same, the worst
  std::string reason{};
};

struct MergeOutcome {
  std::vector<MergedSession> sessions{};  ///< of the merged map; none: nothing was tied
  std::vector<SessionTie> ties{};
  std::vector<MapApart> apart{};
  std::vector<std::filesystem::path> incomplete{};  ///< merged maps whose runs had not ended
  std::size_t components = 0;                       ///< parts that nothing ties together
  std::size_t fixes_used = 0;                       ///< GNSS fixes that count
  std::size_t control = 0;                          ///< control points that count
  bool georeferenced = false;
};

/// The maps that are tied to none of the others, with their reasons.
std::vector<MapApart> maps_apart(const std::vector<MergeInput>& inputs, const MergedMap& merged);

/// Writes maps that are tied as one, unless nothing was tied to anything. Throws InputError and
/// OutputError; then nothing is written.
MergeOutcome write_merged_map(const TiedMaps& tied, const UnfinishedMap& unfinished);

/// Writes the merged map, unless nothing was tied to anything. The inputs are only read.
/// `on_step` as of merge_maps(). Throws UsageError, InputError, LockedError, OutputError,
/// MergeStopped and what the device throws; then nothing is written.
MergeOutcome merge_job(const MergeCommandOptions& options,
                       const std::function<bool(const MergeStep&)>& on_step);

}  // namespace adit
