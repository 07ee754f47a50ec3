// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_database/map_salvage.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>

#include "adit/tools/containers/sqlite_database.hpp"
#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/map_database/sqlite_pages.hpp"
#include "adit/tools/map_database/table_shapes.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr int64_t kNoEnd = std::numeric_limits<int64_t>::max();
constexpr int64_t kMostOfAPage = 4096;  // rows: a wider gap between ids is none of lost rows
constexpr std::size_t kMostPages = 20;

/// Ids that a page may hold: after the first up to the last.
struct Range {
  int64_t after = -1;
  int64_t last = kNoEnd;
};

/// Of a table whose rows are all there; others count from 1.
int64_t first_id(const Shape& shape) {
  const std::string_view table = shape.table;
  return table == "keyframes" || table == "submaps" || table == "end_keyframes" ? 0 : 1;
}

/// A page with rows of a table.
struct Leaf {
  uint32_t page = 0;
  bool in_tree = false;
  uint64_t age = 0;
};

struct Tree {
  std::vector<Leaf> leaves;
  std::vector<Range> hidden;  ///< of pages, or parts of them, that cannot be read
  bool damaged() const { return !hidden.empty(); }
};

using Roots = std::map<std::string, uint32_t>;

/// Which page each table begins at, as the schema of a map says.
Roots roots_of(const SqliteDatabase& map) {
  Roots roots;
  SqliteStatement rows = map.prepare("SELECT name, rootpage FROM sqlite_schema WHERE rootpage > 0");
  while (rows.step()) {
    roots[rows.text(0)] = static_cast<uint32_t>(rows.integer(1));
  }
  return roots;
}

class Salvage {
 public:
  Salvage(const fs::path& damaged, const fs::path& rows)
      : file_(damaged), pages_(damaged), rows_(rows, SqliteDatabase::Mode::update) {
    require_map();
  }

  MapSalvage run() {
    done_.pages = pages_.count();
    const Roots roots = find_roots();
    for (std::size_t i = 0; i < kShapes.size(); ++i) {
      walk_from(i, roots);
    }
    if (log_is_damaged()) {
      // Pages of different times: a tree that looks whole may not lead to all that is there.
      for (std::size_t i = 0; i < kShapes.size(); ++i) {
        trees_[i].hidden.push_back({.after = first_id(kShapes[i]) - 1});
      }
    }
    take_strays();
    rows_.execute("PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; PRAGMA foreign_keys = OFF");
    SqliteTransaction transaction(rows_);
    for (std::size_t i = 0; i < kShapes.size(); ++i) {
      copy(i);
      count_lost(i);
    }
    transaction.commit();
    tell_pages();
    return std::move(done_);
  }

 private:
  void require_map() const {
    const std::optional<SqlitePages::Header>& header = pages_.header();
    if (!header) {
      return;  // what its rows look like tells
    }
    if (header->application != 0 && header->application != kMapApplication) {
      throw InputError(file_, {}, "it is an SQLite database but no map",
                       "Name a map that `adit run` has made");
    }
    // One of less than 1 is none: the rows show what they are.
    if (header->version > kMapSchema) {
      throw InputError(file_, {},
                       "it was written by a newer adit: its schema is " +
                           std::to_string(header->version) + ", this one knows up to " +
                           std::to_string(kMapSchema),
                       "Use that version; nothing was changed");
    }
  }

  /// Where the tables begin: by the damaged map's own schema, and where that cannot be read as in
  /// a new map, whose tables come in the same order.
  Roots find_roots() {
    Roots roots;
    std::vector<uint32_t> open = {1};
    std::set<uint32_t> seen;
    while (!open.empty()) {
      const uint32_t page = open.back();
      open.pop_back();
      if (!seen.insert(page).second) {
        continue;
      }
      const TreePage tree = pages_.tree_page(page);
      used_.insert(page);
      used_.insert(tree.overflow.begin(), tree.overflow.end());
      open.insert(open.end(), tree.children.begin(), tree.children.end());
      const bool is_whole =
          (tree.kind == PageKind::table_leaf || tree.kind == PageKind::table_inside) &&
          !tree.damaged && tree.damaged_rowids.empty();
      if (!is_whole) {
        unreadable_.emplace(page, "the list of tables");
      }
      for (const SqliteRow& row : tree.rows) {
        if (row.values.size() >= 4 && fits(row.values[1], 't') && fits(row.values[3], 'i')) {
          roots[std::get<std::string>(row.values[1])] =
              static_cast<uint32_t>(std::get<int64_t>(row.values[3]));
        }
      }
    }
    if (!unreadable_.empty()) {
      roots.merge(roots_of(rows_));
    }
    return roots;
  }

  void walk_from(std::size_t table, const Roots& roots) {
    const auto root = roots.find(kShapes[table].table);
    if (root != roots.end()) {
      walk(table, root->second, {.after = first_id(kShapes[table]) - 1});
    }
  }

  /// Whether the page may be one of the table's, which its rows show.
  bool is_of(const TreePage& page, const Shape& shape) const {
    const bool index = std::string_view(shape.table) == "provenance";
    if (page.kind == PageKind::none ||
        index != (page.kind == PageKind::index_leaf || page.kind == PageKind::index_inside)) {
      return false;
    }
    return page.rows.empty() ||
           std::ranges::any_of(page.rows, [&](const SqliteRow& row) { return fits(row, shape); });
  }

  void walk(std::size_t table, uint32_t number, Range range) {
    Tree& tree = trees_[table];
    const Shape& shape = kShapes[table];
    const bool again = number == 0 || number > pages_.count() || used_.contains(number);
    const TreePage page = again ? TreePage{} : pages_.tree_page(number);
    if (!is_of(page, shape)) {
      tree.hidden.push_back(range);
      unreadable_.emplace(number, shape.table);
      return;
    }
    used_.insert(number);
    used_.insert(page.overflow.begin(), page.overflow.end());
    note_damage(table, number, page, range);
    if (!page.rows.empty()) {
      tree.leaves.push_back({.page = number, .in_tree = true, .age = pages_.age(number)});
    }
    for (std::size_t i = 0; i < page.children.size(); ++i) {
      Range part = range;
      if (page.children.size() == page.last_rowids.size() + 1) {
        part.after = i > 0 ? page.last_rowids[i - 1] : range.after;
        part.last = i < page.last_rowids.size() ? page.last_rowids[i] : range.last;
      }
      walk(table, page.children[i], part);
    }
  }

  void note_damage(std::size_t table, uint32_t number, const TreePage& page, Range range) {
    Tree& tree = trees_[table];
    const bool strange = std::ranges::any_of(
        page.rows, [&](const SqliteRow& row) { return !fits(row, kShapes[table]); });
    if (page.damaged || strange) {
      tree.hidden.push_back(range);
    }
    for (const int64_t id : page.damaged_rowids) {
      tree.hidden.push_back({.after = id - 1, .last = id});
    }
    if (page.damaged || strange) {
      unreadable_.emplace(number, kShapes[table].table);
    } else if (!page.damaged_rowids.empty()) {
      broken_off_.emplace(number, kShapes[table].table);
    }
  }

  /// Pages that damaged pages led to: of the tables that lack some.
  void take_strays() {
    for (const uint32_t page : pages_.free_pages()) {
      used_.insert(page);
    }
    for (uint32_t number = 1; number <= pages_.count(); ++number) {
      if (used_.contains(number) || pages_.kind(number) == PageKind::none) {
        continue;
      }
      const TreePage page = pages_.tree_page(number);
      for (std::size_t i = 0; i < kShapes.size() && !page.rows.empty(); ++i) {
        if (kShapes[i].by_shape && trees_[i].damaged() && is_of(page, kShapes[i])) {
          used_.insert(number);
          used_.insert(page.overflow.begin(), page.overflow.end());
          trees_[i].leaves.push_back({.page = number, .in_tree = false, .age = pages_.age(number)});
          // Their neighbours show what is missing of them.
          for (const int64_t id : page.damaged_rowids) {
            trees_[i].hidden.push_back({.after = id - 1, .last = id});
          }
          break;
        }
      }
    }
    for (uint32_t number = 1; number <= pages_.count(); ++number) {
      if (!used_.contains(number) && !unreadable_.contains(number) &&
          pages_.kind(number) == PageKind::none && !pages_.is_blank(number)) {
        has_unknown_pages_ = true;
      }
    }
  }

  /// Of two rows of one id the one that a tree leads to counts, or that was written later.
  void copy(std::size_t table) {
    const Shape& shape = kShapes[table];
    std::vector<Leaf>& leaves = trees_[table].leaves;
    std::ranges::sort(leaves, [](const Leaf& a, const Leaf& b) {
      return std::tuple(a.in_tree, a.age, a.page) < std::tuple(b.in_tree, b.age, b.page);
    });
    SalvagedTable& salvaged = done_.tables[shape.table];
    std::optional<SqliteStatement> insert;
    if (shape.by_shape) {
      std::string marks = "?";
      for (std::size_t i = 1; i < shape.columns.size(); ++i) {
        marks += ", ?";
      }
      insert.emplace(rows_.prepare("INSERT OR REPLACE INTO " + std::string(shape.table) +
                                   " VALUES(" + marks + ")"));
    }
    std::set<int64_t> changed;
    for (const Leaf& leaf : leaves) {
      for (const SqliteRow& row : pages_.tree_page(leaf.page).rows) {
        if (!fits(row, shape) ||
            (shape.table == std::string_view("georeference") && row.rowid != 1)) {
          continue;
        }
        if (!is_as_written(row, shape)) {
          changed.insert(row.rowid);
          if (shape.by_shape) {  // others are not needed
            ++salvaged.changed;
            changed_.emplace(leaf.page, shape.table);
          }
          continue;
        }
        salvaged.ids.insert(row.rowid);
        if (shape.table == std::string_view("chunks")) {
          done_.chunk_keyframes.insert(std::get<int64_t>(row.values[0]));
        }
        if (insert) {
          bind(*insert, row, shape);
          insert->step();
          insert->reset();
        }
      }
    }
    lose_changed(salvaged, changed);
  }

  /// Another copy of a changed row may be as it was written.
  static void lose_changed(SalvagedTable& salvaged, const std::set<int64_t>& changed) {
    std::ranges::set_difference(changed, salvaged.ids,
                                std::inserter(salvaged.lost, salvaged.lost.end()));
  }

  static void bind(SqliteStatement& insert, const SqliteRow& row, const Shape& shape) {
    for (std::size_t i = 0; i < shape.columns.size(); ++i) {
      const int parameter = static_cast<int>(i) + 1;
      if (shape.columns[i] == 'n') {
        insert.bind(parameter, row.rowid);
      } else if (i >= row.values.size()) {
        insert.bind(parameter, int64_t{0});
      } else if (const auto* integer = std::get_if<int64_t>(&row.values[i])) {
        insert.bind(parameter, *integer);
      } else if (const auto* real = std::get_if<double>(&row.values[i])) {
        insert.bind(parameter, *real);
      } else if (const auto* text = std::get_if<std::string>(&row.values[i])) {
        insert.bind(parameter, std::string_view(*text));
      } else {
        insert.bind(parameter,
                    std::span<const std::byte>(std::get<std::vector<std::byte>>(row.values[i])));
      }
    }
  }

  /// Ids are given one after the other: what is missing of them where pages are damaged was there.
  void count_lost(std::size_t table) {
    SalvagedTable& salvaged = done_.tables[kShapes[table].table];
    const bool strays =
        std::ranges::any_of(trees_[table].leaves, [](const Leaf& leaf) { return !leaf.in_tree; });
    for (const Range& range : trees_[table].hidden) {
      int64_t last = range.last;
      if (last == kNoEnd) {
        // A page that only led to others, all of which were found, has lost nothing.
        salvaged.may_lack_more |= !strays || has_unknown_pages_;
        last = salvaged.ids.empty() ? range.after : *salvaged.ids.rbegin();
      }
      int64_t before = range.after;
      for (auto id = salvaged.ids.upper_bound(before); before < last; ++id) {
        const int64_t next = id == salvaged.ids.end() || *id > last ? last + 1 : *id;
        lose(salvaged, before + 1, next);
        if (next > last) {
          break;
        }
        before = next;
      }
    }
  }

  static void lose(SalvagedTable& salvaged, int64_t from, int64_t end) {
    if (end - from > kMostOfAPage) {
      salvaged.may_lack_more = true;
      return;
    }
    for (int64_t id = from; id < end; ++id) {
      salvaged.lost.insert(id);
    }
  }

  bool log_is_damaged() const {
    const WriteAheadLog& log = pages_.log();
    return log.damaged || (log.page_size > 0 && !log.header_is_whole);
  }

  void tell_pages() {
    if (pages_.header() && pages_.header()->version < 1) {
      done_.damaged_pages.push_back("page 1: its schema version is " +
                                    std::to_string(pages_.header()->version) +
                                    ", which does not exist");
    }
    for (const auto& [page, table] : unreadable_) {
      if (std::ranges::any_of(kShapes, [&](const Shape& shape) {
            return shape.table == table && !shape.by_shape;
          })) {
        continue;  // it is made anew, or not needed
      }
      if (done_.damaged_pages.size() == kMostPages) {
        done_.damaged_pages.emplace_back("and more");
        break;
      }
      const bool missing = page == 0 || page > pages_.count();
      done_.damaged_pages.push_back("page " + std::to_string(page) + ", of " + table + ": " +
                                    (missing ? "the file ends before it" : "it is damaged"));
    }
    for (const auto& [page, table] : changed_) {
      if (done_.damaged_pages.size() < kMostPages) {
        done_.damaged_pages.push_back("page " + std::to_string(page) + ", of " + table +
                                      ": a row is not as it was written: its checksum does not "
                                      "match");
      }
    }
    for (const auto& [page, table] : broken_off_) {
      if (done_.damaged_pages.size() < kMostPages) {
        done_.damaged_pages.push_back("a page that a row of " + table + " in page " +
                                      std::to_string(page) + " goes on in");
      }
    }
    if (log_is_damaged()) {
      const WriteAheadLog& log = pages_.log();
      done_.damaged_pages.push_back((log.header_is_whole
                                         ? "frame " + std::to_string(log.damaged.value_or(0))
                                         : std::string("the header")) +
                                    " of " + file_.filename().string() + "-wal");
      done_.log_is_damaged = true;
    }
  }

  fs::path file_;
  SqlitePages pages_;
  SqliteDatabase rows_;
  std::array<Tree, kShapes.size()> trees_;
  std::set<uint32_t> used_;                     ///< pages of which it is known what they are
  std::map<uint32_t, std::string> unreadable_;  ///< pages, and what they belong to
  /// Pages with rows of which only the beginning can be read, and whose they are.
  std::map<uint32_t, std::string> broken_off_;
  std::map<uint32_t, std::string> changed_;  ///< pages with rows not as written, and whose
  bool has_unknown_pages_ = false;
  MapSalvage done_;
};

}  // namespace

MapSalvage salvage_rows(const fs::path& damaged, const fs::path& rows) {
  return Salvage(damaged, rows).run();
}

}  // namespace adit
