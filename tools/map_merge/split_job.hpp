// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit split`: sessions of a map as a map of their own.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "adit/tools/map_merge/merge_job.hpp"

namespace adit {

struct SplitCommandOptions {
  std::filesystem::path map{};
  std::vector<int64_t> sessions{};  ///< by the numbers that `adit info` prints
  std::filesystem::path output{};
  bool json = false;
};

struct SplitOutcome {
  std::vector<MergedSession> sessions{};  ///< as the new map numbers them
  std::size_t edges = 0;                  ///< of the odometry
  std::size_t loops = 0;                  ///< that count
  std::size_t components = 0;             ///< parts that nothing ties together any more
  bool georeferenced = false;
};

/// Writes the sessions' keyframes with what lies among them: edges, loop candidates, fixes, control
/// points, and the map's place in the world. Poses, keyframe ids and edges stay as they are; what
/// led to other sessions is left out. The map is only read. Throws UsageError (no such session, all
/// of them, the output exists), InputError, LockedError and OutputError; then nothing is written.
SplitOutcome split_job(const SplitCommandOptions& options);

/// What was written, for people.
std::string describe(const SplitCommandOptions& options, const SplitOutcome& outcome);
/// The same as JSON (docs/schemas/split.schema.json).
std::string to_json(const SplitCommandOptions& options, const SplitOutcome& outcome);

}  // namespace adit
