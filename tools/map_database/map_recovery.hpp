// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace adit {

/// What could be read of a damaged map, and what is known to have been there besides.
struct MapRecovery {
  std::size_t sessions = 0;
  std::size_t keyframes = 0;
  std::size_t edges = 0;
  std::size_t candidates = 0;
  std::size_t fixes = 0;
  std::size_t parts = 0;               ///< without an edge between them, that the new map is in
  std::set<int64_t> lost_keyframes{};  ///< that other rows tell of
  std::set<int64_t> without_points{};  ///< keyframes that are there but for what they have seen
  std::size_t lost_edges = 0;
  std::size_t lost_candidates = 0;
  std::size_t lost_fixes = 0;
  std::size_t lost_control = 0;
  std::size_t lost_headings = 0;
  bool may_lack_more = false;              ///< of which nothing tells
  std::vector<std::string> damaged_pages;  ///< for people: what could not be read
  std::vector<std::string> problems;       ///< for people: what is lost by that
};

/// Writes what is whole of a map into a new one, page by page and row by row, with the log beside
/// it: keyframes, edges, candidates and fixes of keyframes that are there. A keyframe whose points
/// are lost has an empty submap. The damaged map stays as it is. The new one is FILE.part until it
/// is whole. Throws InputError where nothing can be recovered (no map, of a newer schema),
/// LockedError where one of the two is being written, OutputError.
MapRecovery recover_map(const std::filesystem::path& damaged, const std::filesystem::path& whole);

}  // namespace adit
