// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Checksums of a map's rows. SQLite notices damage to the structure of a page, but not to the
// values in it: a flipped bit in a pose is another pose. Each row has an XXH3 of its values in a
// column of its own, which a writer keeps up to date by triggers that live as long as its
// connection. Other programs can therefore read and write a map without knowing the function, and
// `adit check` finds what they have written.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "adit/tools/containers/sqlite_database.hpp"

namespace adit {

/// NULL, INTEGER, REAL, TEXT or BLOB of a row, by reference.
using RowValue =
    std::variant<std::monostate, int64_t, double, std::string_view, std::span<const std::byte>>;
using RowChecksum = std::array<std::byte, 8>;

/// XXH3, 64 bits, of each value's type, length and bytes. A whole number counts as an integer,
/// whichever type it has: SQLite stores one of a REAL column as an integer.
RowChecksum row_checksum(std::span<const RowValue> values);

/// The name of the column in every table of kChecksummedTables; it is the last one.
inline constexpr std::string_view kChecksumColumn = "checksum";

/// A table whose rows have checksums.
struct ChecksummedTable {
  const char* name;
  const char* key;  ///< the first column of its primary key, an integer
};
inline constexpr std::array kChecksummedTables = {
    ChecksummedTable{"sessions", "id"},        ChecksummedTable{"provenance", "session"},
    ChecksummedTable{"keyframes", "id"},       ChecksummedTable{"submaps", "keyframe"},
    ChecksummedTable{"chunks", "keyframe"},    ChecksummedTable{"edges", "id"},
    ChecksummedTable{"candidates", "id"},      ChecksummedTable{"anchors", "session"},
    ChecksummedTable{"fixes", "id"},           ChecksummedTable{"control", "id"},
    ChecksummedTable{"headings", "id"},        ChecksummedTable{"georeference", "id"},
    ChecksummedTable{"end_keyframes", "id"},   ChecksummedTable{"end_edges", "id"},
    ChecksummedTable{"end_candidates", "id"},  ChecksummedTable{"end_fixes", "id"},
    ChecksummedTable{"end_georeference", "id"}};

/// SQL of this connection knows row_checksum(VALUE, ...) from now on.
void define_row_checksum(const SqliteDatabase& map);
/// Adds the column to every table that lacks it, and fills it. row_checksum() is defined.
void add_row_checksums(const SqliteDatabase& map);
/// From now on this connection keeps the checksums of what it writes. row_checksum() is defined.
void keep_row_checksums(const SqliteDatabase& map);
/// Keys of the rows of a table that are not as they were written; none where an older schema lacks
/// the table. row_checksum() is defined.
/// Throws InputError where the table cannot be read.
std::set<int64_t> rows_without_their_checksum(const SqliteDatabase& map,
                                              const ChecksummedTable& table);

}  // namespace adit
