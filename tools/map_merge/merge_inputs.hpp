// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The maps that `adit merge` reads.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "adit/tools/map_database/map_database.hpp"

namespace adit {

/// A map that is to be merged.
struct MergeInput {
  std::filesystem::path file{};
  std::unique_ptr<MapDatabase> map{};    ///< open for reading
  std::vector<MapSession> sessions{};    ///< in order of their ids
  std::vector<MapKeyframe> keyframes{};  ///< in order of their ids, at least one
  std::vector<SessionId> incomplete{};   ///< sessions whose runs have not come to their ends
  double r_submap = 0.0;                 ///< m, edge of a submap's cells
};

/// Opens and checks all of them. They come out in an order that depends on their contents alone:
/// those with more keyframes first. Throws UsageError (fewer than two, one given twice) and
/// InputError or LockedError with the reason: no map, damaged, without keyframes, being written, or
/// of a recording that another one holds.
std::vector<MergeInput> open_merge_inputs(const std::vector<std::filesystem::path>& maps);

/// Throws UsageError where the output exists, also as one of the inputs.
void require_free_output(const std::vector<std::filesystem::path>& maps,
                         const std::filesystem::path& output);

}  // namespace adit
