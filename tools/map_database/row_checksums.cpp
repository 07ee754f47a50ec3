// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_database/row_checksums.hpp"

#include <cmath>
#include <cstring>
#include <new>
#include <type_traits>
#include <vector>

#include <sqlite3.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace adit {
namespace {

/// What a value begins with in the hash, so that no two rows are the same bytes.
enum class Tag : unsigned char { null, integer, real, text, blob };

class RowHash {
 public:
  RowHash() { static_cast<void>(XXH3_64bits_reset(&state_)); }

  void add(const RowValue& value) {
    std::visit([&](const auto& one) { add_one(one); }, value);
  }

  RowChecksum checksum() const {
    XXH64_canonical_t bytes;
    XXH64_canonicalFromHash(&bytes, XXH3_64bits_digest(&state_));
    RowChecksum checksum{};
    std::memcpy(checksum.data(), bytes.digest, sizeof(bytes.digest));
    return checksum;
  }

 private:
  void add_one(std::monostate) { add_tag(Tag::null); }
  void add_one(int64_t number) {
    add_tag(Tag::integer);
    add_bytes(&number, sizeof number);
  }
  void add_one(double number) {
    constexpr double kWholeBelow = 9007199254740992.0;  // 2^53
    if (std::abs(number) < kWholeBelow && number == std::trunc(number)) {
      add_one(static_cast<int64_t>(number));  // -0.0 too, which SQLite stores as 0
      return;
    }
    add_tag(Tag::real);
    add_bytes(&number, sizeof number);
  }
  void add_one(std::string_view text) { add_sized(Tag::text, text.data(), text.size()); }
  void add_one(std::span<const std::byte> blob) { add_sized(Tag::blob, blob.data(), blob.size()); }

  void add_sized(Tag tag, const void* data, uint64_t size) {
    add_tag(tag);
    add_bytes(&size, sizeof size);
    add_bytes(data, size);
  }
  void add_tag(Tag tag) { add_bytes(&tag, sizeof tag); }
  void add_bytes(const void* data, std::size_t size) {
    if (size > 0) {
      static_cast<void>(XXH3_64bits_update(&state_, data, size));
    }
  }

  XXH3_state_t state_;
};

RowValue value_of(sqlite3_value* value) {
  const auto size = [&] { return static_cast<std::size_t>(sqlite3_value_bytes(value)); };
  switch (sqlite3_value_type(value)) {
    case SQLITE_INTEGER:
      return int64_t{sqlite3_value_int64(value)};
    case SQLITE_FLOAT:
      return sqlite3_value_double(value);
    case SQLITE_TEXT: {
      const auto* text = reinterpret_cast<const char*>(sqlite3_value_text(value));
      return std::string_view(text, size());
    }
    case SQLITE_BLOB: {
      const auto* blob = static_cast<const std::byte*>(sqlite3_value_blob(value));
      return std::span<const std::byte>(blob, size());
    }
    default:
      return std::monostate();
  }
}

void checksum_function(sqlite3_context* context, int count, sqlite3_value** values) {
  RowHash hash;
  for (int i = 0; i < count; ++i) {
    hash.add(value_of(values[i]));
  }
  const RowChecksum checksum = hash.checksum();
  sqlite3_result_blob(context, checksum.data(), static_cast<int>(checksum.size()),
                      SQLITE_TRANSIENT);
}

/// The columns of a table.
struct Columns {
  std::string hashed;  ///< all but the checksum, with commas between them
  std::string old;     ///< the same as a trigger names them before an update
  std::string key;     ///< "a = NEW.a AND b = NEW.b" of the primary key
  bool has_checksum = false;
};

Columns columns_of(const SqliteDatabase& map, const std::string& table) {
  Columns columns;
  SqliteStatement rows = map.prepare("SELECT name, pk FROM pragma_table_info('" + table + "')");
  while (rows.step()) {
    const std::string name = rows.text(0);
    if (name == kChecksumColumn) {
      columns.has_checksum = true;
    } else {
      columns.hashed.append(columns.hashed.empty() ? "" : ", ").append(name);
      columns.old.append(columns.old.empty() ? "OLD." : ", OLD.").append(name);
    }
    if (rows.integer(1) > 0) {
      columns.key.append(columns.key.empty() ? "" : " AND ").append(name + " = NEW." + name);
    }
  }
  return columns;
}

std::string update_of(const std::string& table, const Columns& columns) {
  return "UPDATE " + table + " SET checksum = row_checksum(" + columns.hashed + ")";
}

}  // namespace

RowChecksum row_checksum(std::span<const RowValue> values) {
  RowHash hash;
  for (const RowValue& value : values) {
    hash.add(value);
  }
  return hash.checksum();
}

void define_row_checksum(const SqliteDatabase& map) {
  if (sqlite3_create_function_v2(map.handle(), "row_checksum", -1,
                                 SQLITE_UTF8 | SQLITE_DETERMINISTIC, nullptr, &checksum_function,
                                 nullptr, nullptr, nullptr) != SQLITE_OK) {
    throw std::bad_alloc();  // nothing else is wrong with these arguments
  }
}

// A checksum of as many bytes is there from the beginning: a row keeps its length when its own is
// filled in, so SQLite writes over those bytes alone, however long the row is.
void add_row_checksums(const SqliteDatabase& map) {
  for (const ChecksummedTable& table : kChecksummedTables) {
    if (columns_of(map, table.name).has_checksum) {
      continue;
    }
    map.execute(std::string("ALTER TABLE ") + table.name +
                " ADD COLUMN checksum BLOB NOT NULL DEFAULT x'0000000000000000'");
    map.execute(update_of(table.name, columns_of(map, table.name)));
  }
}

// A row that was damaged before an update stays one: what the update leaves of it is not trusted.
void keep_row_checksums(const SqliteDatabase& map) {
  for (const ChecksummedTable& table : kChecksummedTables) {
    const std::string name = table.name;
    const Columns columns = columns_of(map, name);
    const std::string update =
        " BEGIN " + update_of(name, columns) + " WHERE " + columns.key + "; END;";
    map.execute("CREATE TEMP TRIGGER checksum_of_new_" + name + " AFTER INSERT ON main." + name +
                update + "CREATE TEMP TRIGGER checksum_of_changed_" + name + " AFTER UPDATE OF " +
                columns.hashed + " ON main." + name + " WHEN OLD.checksum IS row_checksum(" +
                columns.old + ")" + update);
  }
}

std::set<int64_t> rows_without_their_checksum(const SqliteDatabase& map,
                                              const ChecksummedTable& table) {
  std::set<int64_t> keys;
  if (columns_of(map, table.name).key.empty()) {
    return keys;
  }
  SqliteStatement rows = map.prepare(std::string("SELECT ") + table.key + " FROM " + table.name +
                                     " WHERE checksum IS NOT row_checksum(" +
                                     columns_of(map, table.name).hashed + ")");
  while (rows.step()) {
    keys.insert(rows.integer(0));
  }
  return keys;
}

}  // namespace adit
