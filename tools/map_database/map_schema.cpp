// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_database/map_schema.hpp"

#include <array>
#include <string>

#include "adit/tools/map_database/row_checksums.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

constexpr const char* kTables =
    "CREATE TABLE sessions(id INTEGER PRIMARY KEY, name TEXT NOT NULL, configuration TEXT NOT "
    "NULL, steps INTEGER NOT NULL DEFAULT 0, ending INTEGER NOT NULL DEFAULT 0,"
    " complete INTEGER NOT NULL DEFAULT 0, edited INTEGER NOT NULL DEFAULT 0);"
    "CREATE TABLE provenance(session INTEGER NOT NULL REFERENCES sessions(id), key TEXT NOT NULL,"
    " value TEXT NOT NULL, PRIMARY KEY(session, key)) WITHOUT ROWID;"
    "CREATE TABLE keyframes(id INTEGER PRIMARY KEY, session INTEGER NOT NULL REFERENCES "
    "sessions(id),"
    " stamp_ns INTEGER NOT NULL, fixed INTEGER NOT NULL, pose BLOB NOT NULL,"
    " covariance BLOB NOT NULL, vertical INTEGER NOT NULL DEFAULT 0);"
    "CREATE TABLE submaps(keyframe INTEGER PRIMARY KEY REFERENCES keyframes(id), box BLOB NOT NULL,"
    " chunks INTEGER NOT NULL);"
    "CREATE TABLE chunks(keyframe INTEGER NOT NULL REFERENCES submaps(keyframe),"
    " number INTEGER NOT NULL, bytes INTEGER NOT NULL, zstd BLOB NOT NULL,"
    " PRIMARY KEY(keyframe, number));"
    "CREATE TABLE edges(id INTEGER PRIMARY KEY, node_from INTEGER NOT NULL REFERENCES "
    "keyframes(id),"
    " node_to INTEGER NOT NULL REFERENCES keyframes(id), kind INTEGER NOT NULL,"
    " status INTEGER NOT NULL, pose BLOB NOT NULL, information BLOB NOT NULL);"
    "CREATE TABLE candidates(id INTEGER PRIMARY KEY, node_from INTEGER NOT NULL,"
    " node_to INTEGER NOT NULL, verdict INTEGER NOT NULL, pose BLOB NOT NULL, score REAL NOT NULL,"
    " overlap REAL NOT NULL, chi2 REAL NOT NULL, reason TEXT NOT NULL, rms REAL NOT NULL DEFAULT 0,"
    " correction REAL NOT NULL DEFAULT 0, turn REAL NOT NULL DEFAULT 0,"
    " through REAL NOT NULL DEFAULT 0, figure REAL NOT NULL DEFAULT 0,"
    " source INTEGER NOT NULL DEFAULT 0);"
    "CREATE VIRTUAL TABLE places USING rtree(keyframe, min_x, max_x, min_y, max_y, min_z, max_z);";

// What the end of a run changes, as it was before.
constexpr const char* kTablesOfTheEnd =
    "CREATE TABLE end_keyframes(id INTEGER PRIMARY KEY, fixed INTEGER NOT NULL, pose BLOB NOT "
    "NULL);"
    "CREATE TABLE end_edges(id INTEGER PRIMARY KEY, status INTEGER NOT NULL);"
    "CREATE TABLE end_candidates(id INTEGER PRIMARY KEY, node_from INTEGER NOT NULL,"
    " node_to INTEGER NOT NULL, verdict INTEGER NOT NULL, pose BLOB NOT NULL, score REAL NOT NULL,"
    " overlap REAL NOT NULL, chi2 REAL NOT NULL, reason TEXT NOT NULL, rms REAL NOT NULL,"
    " correction REAL NOT NULL, turn REAL NOT NULL, through REAL NOT NULL, figure REAL NOT NULL,"
    " source INTEGER NOT NULL DEFAULT 0);";

// What schema 1 lacks.
constexpr const char* kToSchema2 =
    "ALTER TABLE candidates ADD COLUMN rms REAL NOT NULL DEFAULT 0;"
    "ALTER TABLE candidates ADD COLUMN correction REAL NOT NULL DEFAULT 0;"
    "ALTER TABLE candidates ADD COLUMN turn REAL NOT NULL DEFAULT 0;"
    "ALTER TABLE candidates ADD COLUMN through REAL NOT NULL DEFAULT 0;"
    "ALTER TABLE candidates ADD COLUMN figure REAL NOT NULL DEFAULT 0;";

// What schema 2 lacks. Who made such a map cannot go on with it.
constexpr const char* kToSchema3 =
    "ALTER TABLE sessions ADD COLUMN steps INTEGER NOT NULL DEFAULT 0;"
    "ALTER TABLE sessions ADD COLUMN ending INTEGER NOT NULL DEFAULT 0;"
    "ALTER TABLE sessions ADD COLUMN complete INTEGER NOT NULL DEFAULT 0;"
    "ALTER TABLE sessions ADD COLUMN edited INTEGER NOT NULL DEFAULT 1;";

// What schema 3 lacks, and of that what is lacking in the tables that it has of the end.
constexpr const char* kToSchema4 =
    "ALTER TABLE candidates ADD COLUMN source INTEGER NOT NULL DEFAULT 0;";
constexpr const char* kEndToSchema4 =
    "ALTER TABLE end_candidates ADD COLUMN source INTEGER NOT NULL DEFAULT 0;";

// What schema 4 lacks: how a map lies in the world, and by what.
constexpr const char* kToSchema5 =
    "ALTER TABLE keyframes ADD COLUMN vertical INTEGER NOT NULL DEFAULT 0;";
constexpr const char* kTablesOfTheWorld =
    "CREATE TABLE fixes(id INTEGER PRIMARY KEY, keyframe INTEGER NOT NULL REFERENCES "
    "keyframes(id),"
    " stamp_ns INTEGER NOT NULL, kind INTEGER NOT NULL, latitude REAL NOT NULL,"
    " longitude REAL NOT NULL, altitude REAL NOT NULL, covariance BLOB NOT NULL,"
    " antenna BLOB NOT NULL, path REAL NOT NULL, verdict INTEGER NOT NULL, chi2 REAL NOT NULL,"
    " information BLOB NOT NULL);"
    "CREATE TABLE georeference(id INTEGER PRIMARY KEY CHECK(id = 1), latitude REAL NOT NULL,"
    " longitude REAL NOT NULL, altitude REAL NOT NULL, pose BLOB NOT NULL,"
    " covariance BLOB NOT NULL);"
    "CREATE TABLE end_fixes(id INTEGER PRIMARY KEY, verdict INTEGER NOT NULL, chi2 REAL NOT NULL,"
    " information BLOB NOT NULL, antenna BLOB);"
    "CREATE TABLE end_georeference(id INTEGER PRIMARY KEY, latitude REAL NOT NULL,"
    " longitude REAL NOT NULL, altitude REAL NOT NULL, pose BLOB NOT NULL,"
    " covariance BLOB NOT NULL);";

// What the world's tables of schemas 5 and 6 lack: the end of a run may move antennas.
constexpr const char* kEndToSchema7 = "ALTER TABLE end_fixes ADD COLUMN antenna BLOB;";

// What schema 7 lacks.
constexpr const char* kTableOfControl =
    "CREATE TABLE control(id INTEGER PRIMARY KEY, name TEXT NOT NULL, role INTEGER NOT NULL,"
    " keyframe INTEGER NOT NULL REFERENCES keyframes(id), point BLOB NOT NULL,"
    " marked BLOB NOT NULL, latitude REAL NOT NULL, longitude REAL NOT NULL,"
    " altitude REAL NOT NULL, sigma BLOB NOT NULL);";

// What schema 9 lacks. Axes are in the keyframe's, yaws counter-clockwise from true east.
constexpr const char* kTableOfHeadings =
    "CREATE TABLE headings(id INTEGER PRIMARY KEY, keyframe INTEGER NOT NULL REFERENCES "
    "keyframes(id),"
    " stamp_ns INTEGER NOT NULL, yaw REAL NOT NULL, sigma REAL NOT NULL, axis BLOB NOT NULL,"
    " information REAL NOT NULL);";

// Maps had none at first, and where there is none the frames are the same.
constexpr const char* kTableOfAnchors =
    "CREATE TABLE IF NOT EXISTS anchors(session INTEGER PRIMARY KEY REFERENCES sessions(id),"
    " pose BLOB NOT NULL);";

/// A column that a schema has and those before it have not.
struct NewColumn {
  int64_t schema;
  const char* table;
  const char* column;
};
constexpr std::array kNewColumns = {NewColumn{2, "candidates", "rms"},
                                    NewColumn{3, "sessions", "steps"},
                                    NewColumn{4, "candidates", "source"},
                                    NewColumn{5, "keyframes", "vertical"},
                                    NewColumn{7, "end_fixes", "antenna"},
                                    NewColumn{8, "control", "sigma"},
                                    NewColumn{kFirstWithChecksums, "keyframes", "checksum"},
                                    NewColumn{kFirstWithHeadings, "headings", "axis"}};

int64_t pragma(const SqliteDatabase& database, const std::string& name) {
  SqliteStatement statement = database.prepare("PRAGMA " + name);
  return statement.step() ? statement.integer(0) : 0;
}

bool has_column(const SqliteDatabase& database, const NewColumn& column) {
  SqliteStatement row =
      database.prepare("SELECT count(*) FROM pragma_table_info(?) WHERE name = ?");
  return row.bind(1, std::string_view(column.table))
             .bind(2, std::string_view(column.column))
             .step() &&
         row.integer(0) > 0;
}

/// Throws InputError where the header's schema cannot be the one that the tables were made by: a
/// flipped bit in it would hide tables and columns.
void require_tables_of(const SqliteDatabase& map, int64_t schema) {
  const char* kRemedy = "The file is damaged: `adit recover` saves what is whole";
  if (schema < 1) {
    throw InputError(
        map.path(), {},
        "its header has schema version " + std::to_string(schema) + ", which does not exist",
        kRemedy);
  }
  for (const NewColumn& column : kNewColumns) {
    if (has_column(map, column) != (schema >= column.schema)) {
      throw InputError(map.path(), {},
                       "its header has schema version " + std::to_string(schema) +
                           ", but its tables do not match that version (" + column.table + "." +
                           column.column + ")",
                       kRemedy);
    }
  }
}

}  // namespace

int64_t map_schema_of(const SqliteDatabase& map) {
  return pragma(map, "user_version");
}

bool is_blank_map(const SqliteDatabase& database) {
  SqliteStatement tables = database.prepare("SELECT count(*) FROM sqlite_schema");
  return pragma(database, "application_id") == 0 && tables.step() && tables.integer(0) == 0;
}

void require_map(const SqliteDatabase& database) {
  const SqliteSnapshot snapshot(database);  // a writer may bring it to another schema
  const std::filesystem::path& file = database.path();
  if (is_blank_map(database)) {
    throw InputError(file, {},
                     "it holds nothing: its run was stopped before it had begun, or it is a copy "
                     "without the " +
                         file.filename().string() + "-wal that lay beside it",
                     "Copy that too, or start the run again");
  }
  if (pragma(database, "application_id") != kMapApplication) {
    throw InputError(file, {}, "it is an SQLite database but no map",
                     "Name a map that `adit run` has made");
  }
  const int64_t schema = pragma(database, "user_version");
  if (schema > kMapSchema) {
    throw InputError(file, {},
                     "it was written by a newer adit: its schema is " + std::to_string(schema) +
                         ", this one knows up to " + std::to_string(kMapSchema),
                     "Use that version; nothing was changed");
  }
  require_tables_of(database, schema);
}

void create_map_tables(const SqliteDatabase& map) {
  map.execute("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL");
  SqliteTransaction transaction(map);
  map.execute(kTables);
  map.execute(kTablesOfTheEnd);
  map.execute(kTablesOfTheWorld);
  map.execute(kTableOfControl);
  map.execute(kTableOfAnchors);
  map.execute(kTableOfHeadings);
  add_row_checksums(map);
  map.execute("PRAGMA application_id = " + std::to_string(kMapApplication));
  map.execute("PRAGMA user_version = " + std::to_string(kMapSchema));
  transaction.commit();
}

// A map of an older schema is brought to this one by its first writer.
void migrate_map(const SqliteDatabase& map) {
  const int64_t schema = pragma(map, "user_version");
  if (schema >= kMapSchema) {
    return;
  }
  SqliteTransaction transaction(map);
  if (schema < 2) {
    map.execute(kToSchema2);
  }
  if (schema < 3) {
    map.execute(kToSchema3);
    map.execute(kTablesOfTheEnd);
  } else if (schema < 4) {
    map.execute(kEndToSchema4);
  }
  if (schema < 4) {
    map.execute(kToSchema4);
  }
  if (schema < 5) {
    map.execute(kToSchema5);
    map.execute(kTablesOfTheWorld);
  } else if (schema < 7) {
    map.execute(kEndToSchema7);
  }
  if (schema < 8) {
    map.execute(kTableOfControl);
  }
  map.execute(kTableOfAnchors);
  map.execute(kTableOfHeadings);
  add_row_checksums(map);
  map.execute("PRAGMA user_version = " + std::to_string(kMapSchema));
  transaction.commit();
}

}  // namespace adit
