// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the rows of a map's tables look like, by which a row is known that has lost its table.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "adit/tools/map_database/sqlite_pages.hpp"

namespace adit {

/// A table by what its rows look like, a letter a column: n NULL (the id stands apart), i INTEGER,
/// r a number, t TEXT, b BLOB, c a checksum; blobs of doubles: p 12, m 36, s 9, v 3, x 6. Rows that
/// were written by an older schema end after the first `least` columns; what they lack is 0.
struct Shape {
  const char* table;
  std::string_view columns;
  std::size_t least;
  bool by_shape;  ///< no other table's rows look like it, but for the tables of the end
};

inline constexpr std::array kShapes = {
    Shape{"sessions", "nttiiiic", 3, true},
    Shape{"provenance", "ittc", 3, true},
    Shape{"keyframes", "niiipmic", 6, true},
    Shape{"submaps", "nxic", 3, true},
    Shape{"chunks", "iiibc", 4, true},
    Shape{"edges", "niiiipmc", 7, true},
    Shape{"candidates", "niiiprrrtrrrrric", 9, true},
    Shape{"fixes", "niiirrrsvrirsc", 13, true},
    Shape{"georeference", "nrrrpmc", 6, true},
    Shape{"headings", "niirrvrc", 7, true},
    Shape{"control", "ntiivvrrrvc", 10, true},
    Shape{"anchors", "npc", 2, true},
    Shape{"end_keyframes", "nipc", 3, false},
    Shape{"end_edges", "nic", 2, false},
    Shape{"end_candidates", "niiiprrrtrrrrric", 9, false},
    Shape{"end_fixes", "nirsvc", 4, false},
    Shape{"end_georeference", "nrrrpmc", 6, false},
    // The index of places is made anew; its pages are no rows that have lost their tree.
    Shape{"places_rowid", "n*", 2, false},
    Shape{"places_node", "n*", 2, false},
    Shape{"places_parent", "n*", 2, false},
};

/// The value can be one of the column.
bool fits(const SqliteValue& value, char letter);
/// The row can be one of the table.
bool fits(const SqliteRow& row, const Shape& shape);
/// A row that fits is as it was written, as far as it has a checksum, which older schemas lack.
bool is_as_written(const SqliteRow& row, const Shape& shape);

}  // namespace adit
