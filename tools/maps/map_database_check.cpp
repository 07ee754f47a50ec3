// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "adit/tools/maps/id_ranges.hpp"
#include "adit/tools/maps/map_database.hpp"
#include "adit/tools/maps/write_ahead_log.hpp"

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

/// Findings of a check in order, each cause once.
class Findings {
 public:
  void add(const std::string& text) {
    if (std::ranges::find(texts_, text) == texts_.end()) {
      texts_.push_back(text);
    }
  }
  /// Of one of many: those with the same cause are one finding.
  void add(int64_t id, const std::string& cause) { of_cause_[cause].insert(id); }

  std::vector<std::string> take(const std::string& what) {
    for (const auto& [cause, ids] : of_cause_) {
      add(what + " " + ranges_of(ids) + ": " + cause);
    }
    return std::move(texts_);
  }

 private:
  std::vector<std::string> texts_;
  std::map<std::string, std::set<int64_t>> of_cause_;
};

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

}  // namespace

std::vector<std::string> MapDatabase::check() const {
  Findings findings;
  const auto attempt = [&](const std::string& what, const auto& action) {
    try {
      action();
      return true;
    } catch (const FileError& error) {
      findings.add(what + ": " + found_in(error));
      return false;
    }
  };
  const auto ask = [&](const std::string& what, const std::string& pragma, const auto& tell) {
    return attempt(what, [&] {
      SqliteStatement rows = database_.prepare(pragma);
      while (rows.step()) {
        tell(rows);
      }
    });
  };
  for (const std::string& finding : check_log(database_.path())) {
    findings.add(finding);
  }
  std::map<std::string, std::string> names;
  attempt("the list of tables", [&] { names = names_of_pages(database_); });
  ask("the pages of the database", "PRAGMA integrity_check(20)", [&](const SqliteStatement& row) {
    std::istringstream lines(row.text(0));
    for (std::string line; std::getline(lines, line);) {
      // What a damaged page led to is never used: that says nothing more.
      if (line != "ok" && !line.starts_with("***") && !line.ends_with("is never used")) {
        findings.add("damaged: " + with_table(line, names));
      }
    }
  });
  ask("the references between tables", "PRAGMA foreign_key_check", [&](const SqliteStatement& row) {
    findings.add("a row of the table " + row.text(0) + " refers to one of " + row.text(2) +
                 " that is missing");
  });
  attempt("table sessions", [&] { static_cast<void>(sessions()); });
  const bool nodes_read = attempt("table keyframes", [&] { static_cast<void>(keyframes()); });
  const bool edges_read = attempt("table edges", [&] { static_cast<void>(edges()); });
  const bool fixes_read = attempt("table fixes", [&] { static_cast<void>(fixes()); });
  const bool control_read = attempt("table control", [&] { static_cast<void>(control_points()); });
  const bool world_read = attempt("table georeference", [&] { static_cast<void>(georeference()); });
  if (nodes_read && edges_read && fixes_read && control_read && world_read) {
    attempt("the graph", [&] { static_cast<void>(graph()); });
  }
  attempt("table candidates", [&] { static_cast<void>(candidates()); });
  std::set<NodeId> nodes;
  ask("table keyframes", "SELECT id FROM keyframes",
      [&](const SqliteStatement& row) { nodes.insert(row.integer(0)); });
  for (const NodeId id : nodes) {
    try {
      static_cast<void>(submap(id));
    } catch (const FileError& error) {
      if (is_by_sqlite(error)) {
        findings.add(id, "their tables submaps and chunks " + found_in(error));
      } else {
        findings.add(found_in(error));
      }
    }
  }
  ask("the index of places",
      "SELECT keyframe FROM submaps WHERE keyframe NOT IN (SELECT keyframe FROM places)",
      [&](const SqliteStatement& row) {
        findings.add("submap " + row.text(0) + " is missing from the index of places");
      });
  return findings.take("submaps");
}

}  // namespace adit
