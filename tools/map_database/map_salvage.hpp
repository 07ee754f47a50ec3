// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Rows of a damaged map, page by page, also of those that no tree leads to any more: what SQLite
// would read of it and what it would not.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace adit {

/// What became of a table.
struct SalvagedTable {
  std::set<int64_t> ids;       ///< of rows that are whole
  std::set<int64_t> lost;      ///< of rows that were there: neighbours show it, or they are changed
  std::size_t changed = 0;     ///< rows that are not as they were written, by their checksums
  bool may_lack_more = false;  ///< rows may be lost of which nothing tells
};

struct MapSalvage {
  std::map<std::string, SalvagedTable> tables;  ///< by name
  std::set<int64_t> chunk_keyframes;            ///< with a chunk that is whole
  std::size_t pages = 0;                        ///< of the damaged map, its log included
  std::vector<std::string> damaged_pages;       ///< for people
  bool log_is_damaged = false;                  ///< the log beside the map
};

/// Copies the rows that are whole, and whose checksum matches if they have one, into `rows`, a map
/// without content. Foreign keys may lead nowhere there. Throws InputError where the file is no map
/// or of a newer schema, OutputError.
MapSalvage salvage_rows(const std::filesystem::path& damaged, const std::filesystem::path& rows);

}  // namespace adit
