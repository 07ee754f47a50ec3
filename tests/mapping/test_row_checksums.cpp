// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_database/row_checksums.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "adit/tests/mapping/map_support.hpp"
#include "adit/tests/support/error_text.hpp"
#include "adit/tests/support/temporary_folder.hpp"
#include "adit/tools/map_database/map_recovery.hpp"
#include "adit/tools/support/random.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::dump_of;

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The same with one bit that is another.
std::string flipped(std::string bytes, std::size_t bit) {
  bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ (1 << (bit % 8)));
  return bytes;
}

/// One value of a map, to flip bits in by SQL, as any program may.
class Value {
 public:
  Value(const SqliteDatabase& raw, std::string table, std::string column)
      : raw_(raw), table_(std::move(table)), column_(std::move(column)) {
    SqliteStatement row = select();
    type_ = row.text(0);
    if (type_ == "integer") {
      bytes_.resize(sizeof(int64_t));
      const int64_t number = row.integer(1);
      std::memcpy(bytes_.data(), &number, sizeof number);
    } else if (type_ == "real") {
      bytes_.resize(sizeof(double));
      const double number = row.real(1);
      std::memcpy(bytes_.data(), &number, sizeof number);
    } else {
      const std::span<const std::byte> blob = row.blob(1);
      bytes_.assign(reinterpret_cast<const char*>(blob.data()), blob.size());
    }
    where_ = table_ == "provenance" ? "value = '" + row.text(2) + "'" : "rowid = " + row.text(2);
  }

  const std::string& type() const { return type_; }
  std::size_t bits() const { return 8 * bytes_.size(); }
  void flip(std::size_t bit) { set(flipped(bytes_, bit)); }
  void put_back() { set(bytes_); }

 private:
  SqliteStatement select() const {
    const std::string row = table_ == "provenance" ? "value" : "rowid";
    SqliteStatement statement =
        raw_.prepare("SELECT typeof(" + column_ + "), " + column_ + ", " + row + " FROM " + table_ +
                     " ORDER BY " + row + " DESC LIMIT 1");
    EXPECT_TRUE(statement.step()) << table_ << " has no rows";
    return statement;
  }

  void set(const std::string& bytes) {
    SqliteStatement update =
        raw_.prepare("UPDATE " + table_ + " SET " + column_ + " = ? WHERE " + where_ +
                     " RETURNING " + (table_ == "provenance" ? "value" : "rowid"));
    if (type_ == "integer") {
      int64_t number = 0;
      std::memcpy(&number, bytes.data(), sizeof number);
      update.bind(1, number);
    } else if (type_ == "real") {
      double number = 0.0;
      std::memcpy(&number, bytes.data(), sizeof number);
      update.bind(1, number);
    } else if (type_ == "text") {
      update.bind(1, std::string_view(bytes));
    } else {
      update.bind(1, std::as_bytes(std::span(bytes)));
    }
    ASSERT_TRUE(update.step()) << table_ << "." << column_;
    where_ =
        table_ == "provenance" ? "value = '" + update.text(0) + "'" : "rowid = " + update.text(0);
    while (update.step()) {
    }
  }

  const SqliteDatabase& raw_;
  std::string table_;
  std::string column_;
  std::string type_;
  std::string bytes_;
  std::string where_;
};

class RowChecksums : public testing::Test {
 protected:
  void SetUp() override { test::write_full_map(file_); }

  std::vector<std::string> check(const fs::path& file) const {
    return MapDatabase(file, MapAccess::read).check();
  }
  /// After a statement of another program.
  std::vector<std::string> check_after(const std::string& statement) const {
    SqliteDatabase(file_, SqliteDatabase::Mode::update).execute(statement);
    return check(file_);
  }
  MapRecovery recover_after(const std::string& statement) const {
    SqliteDatabase(file_, SqliteDatabase::Mode::update).execute(statement);
    fs::remove(whole());
    const MapRecovery done = recover_map(file_, whole());
    EXPECT_TRUE(check(whole()).empty());
    return done;
  }
  fs::path whole() const { return folder_ / "whole.adit"; }

  test::TemporaryFolder folder_;
  fs::path file_ = folder_ / "map.adit";
};

bool tells(const std::vector<std::string>& problems, const std::string& words) {
  return std::ranges::any_of(problems, [&](const std::string& problem) {
    return problem.find(words) != std::string::npos;
  });
}

TEST_F(RowChecksums, AMapThatIsWholeHasThemInEveryTable) {
  EXPECT_TRUE(check(file_).empty());
  const SqliteDatabase raw(file_, SqliteDatabase::Mode::update);
  SqliteStatement tables = raw.prepare(
      "SELECT name FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE 'places%'");
  std::size_t count = 0;
  while (tables.step()) {
    const std::string name = tables.text(0);
    EXPECT_TRUE(std::ranges::any_of(kChecksummedTables, [&](const ChecksummedTable& table) {
      return name == table.name;
    })) << name;
    SqliteStatement zeros =
        raw.prepare("SELECT count(*), sum(checksum = x'0000000000000000') FROM " + name);
    ASSERT_TRUE(zeros.step());
    EXPECT_GT(zeros.integer(0), 0) << name << ": the test has no row of it";
    EXPECT_EQ(zeros.integer(1), 0) << name;
    ++count;
  }
  EXPECT_EQ(count, kChecksummedTables.size());
}

TEST_F(RowChecksums, CheckFindsAFlippedBitInEveryColumnOfEveryTable) {
  const SqliteDatabase raw(file_, SqliteDatabase::Mode::update);
  raw.execute("PRAGMA ignore_check_constraints = ON");
  const MapDatabase map(file_, MapAccess::read);
  Random random(11);
  for (const ChecksummedTable& table : kChecksummedTables) {
    std::map<std::string, bool> columns;  // true: of the primary key
    SqliteStatement info =
        raw.prepare(std::string("SELECT name, pk FROM pragma_table_info('") + table.name + "')");
    while (info.step()) {
      columns.emplace(info.text(0), info.integer(1) > 0);
    }
    ASSERT_GE(columns.size(), 3U);
    for (const auto& [column, is_key] : columns) {
      Value value(raw, table.name, column);
      const std::string which = std::string(table.name) + "." + column;
      ASSERT_GT(value.bits(), 0U) << which;
      for (int i = 0; i < 4; ++i) {
        auto bit = static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(value.bits())));
        if (value.type() == "text") {
          bit -= bit % 8;  // it stays one
        } else if (value.type() == "real") {
          bit %= 63;  // SQLite stores no sign of zero
        } else if (value.type() == "integer" && is_key) {
          bit = 20 + bit % 40;  // a number that no row has
        }
        value.flip(bit);
        EXPECT_TRUE(tells(map.check(), table.name)) << which << ", bit " << bit;
        value.put_back();
      }
      ASSERT_TRUE(map.check().empty()) << which;
    }
  }
}

TEST_F(RowChecksums, CheckFindsAnIndexOfPlacesThatIsAnother) {
  const SqliteDatabase raw(file_, SqliteDatabase::Mode::update);
  const MapDatabase map(file_, MapAccess::read);
  raw.execute("CREATE TABLE kept AS SELECT * FROM places");
  for (const char* column : {"min_x", "max_x", "min_y", "max_y", "min_z", "max_z"}) {
    const std::string sign = column[1] == 'i' ? " - " : " + ";
    for (const char* change : {"0.001", "64.0"}) {
      raw.execute(std::string("UPDATE places SET ") + column + " = " + column + sign + change +
                  " WHERE keyframe = 3");
      EXPECT_TRUE(tells(map.check(), "the index of places has other boxes for them")) << column;
      raw.execute("INSERT OR REPLACE INTO places SELECT * FROM kept");
      EXPECT_TRUE(map.check().empty());
    }
  }
  raw.execute("UPDATE places SET keyframe = 99 WHERE keyframe = 3");
  EXPECT_TRUE(tells(map.check(), "submap 99, which does not exist"));
  EXPECT_TRUE(tells(map.check(), "submap 3 is missing"));
}

// As a disk flips them: in the bytes of the file, where SQLite itself has no means to notice.
TEST_F(RowChecksums, CheckFindsEveryBitInThePosesOfKeyframesAndInEdges) {
  const std::string bytes = bytes_of(file_);
  std::vector<std::string> blobs;
  {
    const SqliteDatabase raw(file_, SqliteDatabase::Mode::frozen);
    SqliteStatement rows = raw.prepare(
        "SELECT pose FROM keyframes UNION ALL SELECT information FROM edges UNION ALL SELECT pose "
        "FROM edges WHERE kind = 1 UNION ALL SELECT covariance FROM keyframes");
    while (rows.step()) {
      const std::span<const std::byte> blob = rows.blob(0);
      blobs.emplace_back(reinterpret_cast<const char*>(blob.data()), blob.size());
    }
  }
  ASSERT_EQ(blobs.size(), 6U + 6U + 1U + 6U);
  Random random(3);
  for (std::size_t i = 0; i < blobs.size(); ++i) {
    const std::size_t at = bytes.rfind(blobs[i]);
    ASSERT_NE(at, std::string::npos) << i;
    for (int trial = 0; trial < 12; ++trial) {
      const std::size_t bit = 8 * at + static_cast<std::size_t>(random.uniform(
                                           0.0, 8.0 * static_cast<double>(blobs[i].size())));
      const fs::path damaged = folder_.write("damaged.adit", flipped(bytes, bit));
      EXPECT_TRUE(tells(check(damaged), "not as they were written")) << i << ", bit " << bit;
    }
  }
}

TEST_F(RowChecksums, ABitAnywhereInTheFileIsFoundOrChangesNothing) {
  const std::string bytes = bytes_of(file_);
  const std::string before = dump_of(MapDatabase(file_, MapAccess::read));
  Random random(5);
  std::size_t found = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const auto bit =
        static_cast<std::size_t>(random.uniform(0.0, 8.0 * static_cast<double>(bytes.size())));
    const fs::path damaged = folder_.write("damaged.adit", flipped(bytes, bit));
    try {
      if (check(damaged).empty()) {
        EXPECT_EQ(dump_of(MapDatabase(damaged, MapAccess::read)), before) << "bit " << bit;
      } else {
        ++found;
      }
    } catch (const FileError&) {
      ++found;
    }
  }
  EXPECT_GT(found, 20U) << "much of a small map is free space";
}

TEST_F(RowChecksums, RecoverLeavesChangedRowsOutAndCountsThem) {
  const std::string bytes = bytes_of(file_);
  const auto whole_again = [&] { folder_.write("map.adit", bytes); };
  const std::string flip =
      " SET pose = CAST(substr(pose, 1, 8) || x'01' || substr(pose, 10) AS BLOB)";

  MapRecovery done = recover_after("UPDATE keyframes" + flip + " WHERE id = 3");
  EXPECT_EQ(done.lost_keyframes, std::set<int64_t>{3});
  EXPECT_EQ(done.keyframes, 5U);
  EXPECT_EQ(done.lost_edges, 2U) << "those to it";
  EXPECT_TRUE(tells(done.damaged_pages, "of keyframes: a row is not as it was written"));

  whole_again();
  done = recover_after("UPDATE edges" + flip + " WHERE id = 2");
  EXPECT_EQ(done.lost_edges, 1U);
  EXPECT_EQ(done.edges, 5U);
  EXPECT_TRUE(tells(done.problems, "edges 2 are lost"));

  whole_again();
  done = recover_after(
      "UPDATE fixes SET altitude = 0 WHERE id = 1; UPDATE candidates SET overlap = 0 WHERE id = 2;"
      "UPDATE control SET name = 'tower'");
  EXPECT_EQ(done.lost_fixes, 1U);
  EXPECT_EQ(done.lost_candidates, 1U);
  EXPECT_EQ(done.lost_control, 1U);

  whole_again();
  done = recover_after("UPDATE chunks SET bytes = bytes + 1 WHERE keyframe = 4 AND number = 1");
  EXPECT_EQ(done.without_points, std::set<int64_t>{4});

  whole_again();
  done = recover_after(
      "UPDATE provenance SET value = 'other' WHERE key = 'device'; UPDATE georeference SET "
      "latitude "
      "= 50; UPDATE anchors" +
      flip + "; UPDATE sessions SET name = 'x'");
  EXPECT_TRUE(tells(done.problems, "provenance: 1 row is lost"));
  EXPECT_TRUE(tells(done.problems, "georeference: 1 row is lost"));
  EXPECT_TRUE(tells(done.problems, "anchors: 1 row is lost"));
  EXPECT_TRUE(tells(done.problems, "session 1: its name and settings are lost"));
  EXPECT_EQ(done.keyframes, 6U);
}

TEST_F(RowChecksums, AMapWithoutThemIsReadAndItsFirstWriterAddsThem) {
  SqliteDatabase(file_, SqliteDatabase::Mode::update)
      .execute("DELETE FROM headings");  // which that schema did not have
  const std::string before = dump_of(MapDatabase(file_, MapAccess::read));
  test::make_schema_8(file_);
  {
    const MapDatabase old(file_, MapAccess::read);
    EXPECT_FALSE(old.has_checksums());
    EXPECT_TRUE(old.check().empty());
    EXPECT_EQ(dump_of(old), before);
  }
  EXPECT_TRUE(recover_map(file_, whole()).problems.empty());
  EXPECT_TRUE(MapDatabase(whole(), MapAccess::read).has_checksums());
  {
    const MapDatabase writer(file_, MapAccess::write);
    EXPECT_EQ(dump_of(writer), before);
  }
  EXPECT_TRUE(MapDatabase(file_, MapAccess::read).has_checksums());
  EXPECT_TRUE(check(file_).empty());
  EXPECT_TRUE(tells(check_after("UPDATE edges SET status = 1 WHERE id = 1"), "edges 1: not as"));
}

// What is written to a damaged row later does not hide the damage.
TEST_F(RowChecksums, AnUpdateOfADamagedRowDoesNotMakeItWhole) {
  SqliteDatabase(file_, SqliteDatabase::Mode::update)
      .execute("UPDATE keyframes SET stamp_ns = stamp_ns + 1 WHERE id = 3");
  {
    MapDatabase map(file_, MapAccess::write);
    std::vector<PoseNode> poses = map.graph().nodes();
    for (PoseNode& node : poses) {
      node.T_map_node.translation().z() += 1.0;
    }
    map.revise({.poses = poses});
  }
  EXPECT_EQ(check(file_), std::vector<std::string>{
                              "keyframes 3: not as they were written: their checksums do not "
                              "match"});
}

// Another program needs to know nothing of them, and check shows what it has written.
TEST_F(RowChecksums, WhatAnotherProgramWritesIsFound) {
  EXPECT_TRUE(tells(check_after("INSERT INTO edges(node_from, node_to, kind, status, pose, "
                                "information) SELECT node_from, node_to, kind, status, pose, "
                                "information FROM edges WHERE id = 1"),
                    "edges 7: not as they were written"));
}

TEST_F(RowChecksums, AHeaderOfAnotherSchemaThanTheTablesIsFound) {
  for (const int schema : {0, -1, 1, 2, 3, 4, 5, 6, 7, 8, 9, -1000}) {
    SqliteDatabase(file_, SqliteDatabase::Mode::update)
        .execute("PRAGMA user_version = " + std::to_string(schema));
    for (const MapAccess access : {MapAccess::read, MapAccess::write}) {
      const std::string error =
          test::error_of<InputError>([&] { const MapDatabase map(file_, access); });
      EXPECT_NE(error.find("its header has schema version " + std::to_string(schema)),
                std::string::npos)
          << error;
    }
    fs::remove(whole());
    const MapRecovery done = recover_map(file_, whole());
    EXPECT_TRUE(done.problems.empty()) << schema;
    EXPECT_EQ(done.keyframes, 6U) << schema;
  }
  SqliteDatabase(file_, SqliteDatabase::Mode::update).execute("PRAGMA user_version = 10");
  test::make_schema_8(file_);
  SqliteDatabase(file_, SqliteDatabase::Mode::update).execute("PRAGMA user_version = 10");
  EXPECT_NE(test::error_of<InputError>([&] {
              static_cast<void>(check(file_));
            }).find("schema version 10"),
            std::string::npos);
}

TEST(RowChecksum, TellsValuesApartAndTypesThatSqliteDoesNotKeep) {
  const auto of = [](std::vector<RowValue> values) { return row_checksum(values); };
  const std::vector<std::byte> one = {std::byte{'a'}};
  const std::vector<std::vector<RowValue>> different = {
      {},
      {std::monostate()},
      {std::monostate(), std::monostate()},
      {int64_t{0}},
      {int64_t{1}},
      {std::nextafter(1.0, 2.0)},
      {0.5},
      {-0.5},
      {std::string_view("a")},
      {std::span<const std::byte>(one)},
      {std::string_view("a"), std::string_view("b")},
      {std::string_view("ab"), std::string_view("")},
      {std::string_view(""), std::string_view("ab")}};
  for (std::size_t i = 0; i < different.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_NE(of(different[i]), of(different[j])) << i << " " << j;
    }
  }
  EXPECT_EQ(of({2.0}), of({int64_t{2}})) << "a REAL column's whole number is an integer on disk";
  EXPECT_EQ(of({-0.0}), of({0.0})) << "SQLite stores no sign of zero";
}

}  // namespace
}  // namespace adit
