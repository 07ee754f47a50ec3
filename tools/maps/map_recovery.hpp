// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace adit {

/// What could be read of a damaged map.
struct MapRecovery {
  std::size_t sessions = 0;
  std::size_t keyframes = 0;
  std::size_t edges = 0;
  std::size_t candidates = 0;
  std::size_t lost_keyframes = 0;  ///< as far as their numbers are known
  std::size_t lost_edges = 0;
  std::vector<std::string> problems;  ///< for people: what could not be read
};

/// Writes what is whole of a map into a new one, row by row: keyframes with their submaps, edges
/// and candidates between keyframes that are there. The damaged map stays as it is. Throws
/// InputError where nothing can be read (no map, of a newer schema), OutputError.
MapRecovery recover_map(const std::filesystem::path& damaged, const std::filesystem::path& whole);

}  // namespace adit
