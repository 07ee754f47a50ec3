// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The tables of a map and their versions; docs/formats.md has the columns.
#pragma once

#include <cstdint>

#include "adit/tools/containers/sqlite_database.hpp"

namespace adit {

/// Version of the tables; a file with a higher one is refused.
inline constexpr int64_t kMapSchema = 10;
/// The first one whose rows have checksums.
inline constexpr int64_t kFirstWithChecksums = 9;
/// The first one with headings.
inline constexpr int64_t kFirstWithHeadings = 10;
/// "adit": the application that the file says it belongs to.
inline constexpr int64_t kMapApplication = 0x61646974;

/// The version that the file's header has.
int64_t map_schema_of(const SqliteDatabase& map);

/// A file that nothing was stored in: its writer was killed before.
bool is_blank_map(const SqliteDatabase& database);

/// Throws InputError where the database is no map, is of a newer schema, or has tables of another
/// schema than its header.
void require_map(const SqliteDatabase& database);

/// Makes the tables in a blank database. row_checksum() is defined.
void create_map_tables(const SqliteDatabase& map);

/// Brings a map of an older schema to this one, as a whole or not at all. row_checksum() is
/// defined.
void migrate_map(const SqliteDatabase& map);

}  // namespace adit
