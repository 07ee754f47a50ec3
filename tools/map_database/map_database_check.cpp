// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include "adit/tools/map_database/id_ranges.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_database/row_checksums.hpp"
#include "adit/tools/map_database/write_ahead_log.hpp"

namespace adit {
namespace {

constexpr std::string_view kBySqlite = "cannot be read as an SQLite database: ";

/// What was found, without what the one who runs a check knows: that it is an SQLite database.
std::string found_in(const FileError& error) {
  const auto* input = dynamic_cast<const InputError*>(&error);
  const std::string text = input != nullptr ? input->found() : error.what();
  return text.starts_with(kBySqlite) ? "cannot be read: " + text.substr(kBySqlite.size()) : text;
}

bool is_by_sqlite(const FileError& error) {
  const auto* input = dynamic_cast<const InputError*>(&error);
  return input != nullptr && input->found().starts_with(kBySqlite);
}

/// Which table or index begins at each page.
std::map<std::string, std::string> names_of_pages(const SqliteDatabase& database) {
  std::map<std::string, std::string> names;
  SqliteStatement rows =
      database.prepare("SELECT rootpage, name, tbl_name FROM sqlite_schema WHERE rootpage > 0");
  while (rows.step()) {
    const std::string table = rows.text(2);
    names[rows.text(0)] = rows.text(1) == table ? "table " + table : "an index of table " + table;
  }
  return names;
}

/// A line of SQLite's own check with the name of the table, where it names the first page of one.
std::string with_table(const std::string& line, const std::map<std::string, std::string>& names) {
  for (const std::string_view word : {"tree ", "Tree ", "page ", "Page "}) {
    const std::size_t at = line.find(word);
    if (at == std::string::npos) {
      continue;
    }
    const std::size_t begin = at + word.size();
    const auto name =
        names.find(line.substr(begin, line.find_first_not_of("0123456789", begin) - begin));
    if (name != names.end()) {
      return name->second + ": " + line;
    }
  }
  return line;
}

/// "edges", "chunks of keyframes": the rows of a table, before their keys.
std::string rows_of(const ChecksummedTable& table) {
  const std::string key = table.key;
  return key == "id" ? table.name : std::string(table.name) + " of " + key + "s";
}

constexpr const char* kNotAsWritten = "not as they were written: their checksums do not match";

/// The index has single precision, and SQLite rounds outwards by up to two steps of it.
bool is_rounded_place(const Eigen::AlignedBox3d& stored, const Eigen::AlignedBox3d& exact) {
  constexpr double kSteps = 4.0;
  const double farthest =
      std::max(exact.min().cwiseAbs().maxCoeff(), exact.max().cwiseAbs().maxCoeff());
  const double tolerance = kSteps * (std::numeric_limits<float>::epsilon() * farthest +
                                     std::numeric_limits<float>::min());
  return (stored.min() - exact.min()).cwiseAbs().maxCoeff() <= tolerance &&
         (stored.max() - exact.max()).cwiseAbs().maxCoeff() <= tolerance;
}

}  // namespace

/// Reads a map part by part: what cannot be read is a finding, and the next part comes.
class MapDatabase::Check {
 public:
  explicit Check(const MapDatabase& map) : map_(map), database_(map.database_) {}

  std::vector<std::string> run() {
    const SqliteSnapshot snapshot(database_);  // a run may go on with the map meanwhile
    for (const std::string& finding : check_log(database_.path())) {
      findings_.add(finding);
    }
    check_pages();
    const bool whole_pages = findings_.empty();
    ask("the references between tables", "PRAGMA foreign_key_check",
        [&](const SqliteStatement& row) {
          findings_.add("a row of the table " + row.text(0) + " refers to one of " + row.text(2) +
                        " that is missing");
        });
    if (map_.has_checksums()) {
      check_checksums();
    }
    check_rows();
    check_submaps();
    check_places(whole_pages);
    return findings_.take();
  }

 private:
  /// Findings of a check in order, each cause once.
  class Findings {
   public:
    void add(const std::string& text) {
      if (std::ranges::find(texts_, text) == texts_.end()) {
        texts_.push_back(text);
      }
    }
    /// Of one of many: those with the same cause are one finding.
    void add(const std::string& what, int64_t id, const std::string& cause) {
      of_cause_[{what, cause}].insert(id);
    }

    bool empty() const { return texts_.empty() && of_cause_.empty(); }

    std::vector<std::string> take() {
      for (const auto& [which, ids] : of_cause_) {
        add(which.first + " " + ranges_of(ids) + ": " + which.second);
      }
      return std::move(texts_);
    }

   private:
    std::vector<std::string> texts_;
    std::map<std::pair<std::string, std::string>, std::set<int64_t>> of_cause_;
  };

  template <class Action>
  bool attempt(const std::string& what, const Action& action) {
    try {
      action();
      return true;
    } catch (const FileError& error) {
      findings_.add(what + ": " + found_in(error));
      return false;
    }
  }

  template <class Tell>
  bool ask(const std::string& what, const std::string& query, const Tell& tell) {
    return attempt(what, [&] {
      SqliteStatement rows = database_.prepare(query);
      while (rows.step()) {
        tell(rows);
      }
    });
  }

  bool is_damaged(const std::string& table) const { return damaged_.contains(table); }
  bool is_damaged(const std::string& table, int64_t key) const {
    const auto keys = damaged_.find(table);
    return keys != damaged_.end() && keys->second.contains(key);
  }

  void check_pages() {
    std::map<std::string, std::string> names;
    attempt("the list of tables", [&] { names = names_of_pages(database_); });
    ask("the pages of the database", "PRAGMA integrity_check(20)", [&](const SqliteStatement& row) {
      std::istringstream lines(row.text(0));
      for (std::string line; std::getline(lines, line);) {
        // What a damaged page led to is never used: that says nothing more.
        if (line != "ok" && !line.starts_with("***") && !line.ends_with("is never used")) {
          findings_.add("damaged: " + with_table(line, names));
        }
      }
    });
  }

  void check_checksums() {
    for (const ChecksummedTable& table : kChecksummedTables) {
      try {
        for (const int64_t key : rows_without_their_checksum(database_, table)) {
          findings_.add(rows_of(table), key, kNotAsWritten);
          damaged_[table.name].insert(key);
        }
      } catch (const FileError& error) {
        // Where submaps cannot be read, reading one after the other says which.
        if (!is_by_sqlite(error) || table.key != std::string_view("keyframe")) {
          findings_.add(std::string("table ") + table.name + ": " + found_in(error));
        }
      }
    }
  }

  /// What the rows of a table mean; those of a damaged one have been told.
  template <class Read>
  bool check_table(const std::string& table, const Read& read) {
    return !is_damaged(table) && attempt("table " + table, [&] { static_cast<void>(read()); });
  }

  void check_rows() {
    check_table("sessions", [&] { return map_.sessions(); });
    bool whole = check_table("anchors", [&] { return map_.anchors(); });
    whole &= check_table("keyframes", [&] { return map_.keyframes(); });
    whole &= check_table("edges", [&] { return map_.edges(); });
    whole &= check_table("fixes", [&] { return map_.fixes(); });
    whole &= check_table("headings", [&] { return map_.headings(); });
    whole &= check_table("control", [&] { return map_.control_points(); });
    whole &= check_table("georeference", [&] { return map_.georeference(); });
    if (whole) {
      attempt("the graph", [&] { static_cast<void>(map_.graph()); });
    }
    check_table("candidates", [&] { return map_.candidates(); });
  }

  void check_submaps() {
    std::set<NodeId> nodes;
    ask("table keyframes", "SELECT id FROM keyframes",
        [&](const SqliteStatement& row) { nodes.insert(row.integer(0)); });
    for (const NodeId id : nodes) {
      if (is_damaged("submaps", id) || is_damaged("chunks", id)) {
        continue;
      }
      try {
        static_cast<void>(map_.submap(id));
      } catch (const FileError& error) {
        if (is_by_sqlite(error)) {
          findings_.add("submaps", id, "their tables submaps and chunks " + found_in(error));
        } else {
          findings_.add(found_in(error));
        }
      }
    }
  }

  void check_places(bool whole_pages) {
    const char* kIndex = "the index of places";
    ask(kIndex, "SELECT keyframe FROM submaps WHERE keyframe NOT IN (SELECT keyframe FROM places)",
        [&](const SqliteStatement& row) {
          findings_.add("submap " + row.text(0) + " is missing from the index of places");
        });
    ask(kIndex, "SELECT keyframe FROM places WHERE keyframe NOT IN (SELECT keyframe FROM submaps)",
        [&](const SqliteStatement& row) {
          findings_.add("the index of places lists submap " + row.text(0) +
                        ", which does not exist");
        });
    if (!whole_pages || is_damaged("keyframes") || is_damaged("submaps") || is_damaged("anchors")) {
      return;
    }
    ask(kIndex, "SELECT rtreecheck('places')", [&](const SqliteStatement& row) {
      const std::string text = row.text(0);
      if (text != "ok") {
        findings_.add(std::string(kIndex) + ": " + text.substr(0, text.find('\n')));
      }
    });
    attempt(kIndex, [&] {
      const std::map<NodeId, Eigen::AlignedBox3d> boxes = map_.boxes();
      for (const MapKeyframe& keyframe : map_.keyframes()) {
        const auto box = boxes.find(keyframe.id);
        const auto exact = map_.place_of(keyframe.id, keyframe.T_map_keyframe);
        if (box != boxes.end() && exact && !is_rounded_place(box->second, *exact)) {
          findings_.add("submaps", keyframe.id, "the index of places has other boxes for them");
        }
      }
    });
  }

  const MapDatabase& map_;
  const SqliteDatabase& database_;
  Findings findings_;
  std::map<std::string, std::set<int64_t>> damaged_;  ///< tables, and keys of rows not as written
};

bool MapDatabase::has_checksums() const {
  return map_schema_of(database_) >= kFirstWithChecksums;
}

std::vector<std::string> MapDatabase::check() const {
  return Check(*this).run();
}

}  // namespace adit
