// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The pages of a database as SQLite documents them, read without SQLite, which gives up a table
// with its first damaged page. Nothing here is believed: each number is checked before it is used.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

#include "adit/tools/map_database/write_ahead_log.hpp"

namespace adit {

/// NULL, INTEGER, REAL, TEXT or BLOB.
using SqliteValue =
    std::variant<std::monostate, int64_t, double, std::string, std::vector<std::byte>>;

struct SqliteRow {
  int64_t rowid = 0;  ///< 0 in a table without
  std::vector<SqliteValue> values;
};

enum class PageKind { none, index_inside, table_inside, index_leaf, table_leaf };

/// What a page of a tree holds.
struct TreePage {
  PageKind kind = PageKind::none;
  std::vector<SqliteRow> rows;          ///< of leaves, and of an index's inner pages
  std::vector<uint32_t> children;       ///< of inner pages, from left to right
  std::vector<int64_t> last_rowids;     ///< of a table's children but the last
  std::vector<uint32_t> overflow;       ///< pages that its rows go on in
  std::vector<int64_t> damaged_rowids;  ///< of rows that do so and break off there
  bool damaged = false;                 ///< some rows of it are none
};

class SqlitePages {
 public:
  /// With what lies in the log beside it. Throws InputError where the file cannot be read.
  explicit SqlitePages(const std::filesystem::path& file);
  ~SqlitePages();
  SqlitePages(const SqlitePages&) = delete;
  SqlitePages& operator=(const SqlitePages&) = delete;

  uint32_t count() const { return count_; }  ///< pages are numbered from 1
  const WriteAheadLog& log() const { return log_; }

  /// What the first page says; nothing where it is damaged.
  struct Header {
    int64_t application = 0;
    int64_t version = 0;  ///< user_version
    uint32_t pages = 0;
    uint32_t first_free = 0;
  };
  const std::optional<Header>& header() const { return header_; }

  TreePage tree_page(uint32_t number) const;
  /// Its kind alone: the page is as the kind's header has to be.
  PageKind kind(uint32_t number) const;
  /// All bytes are 0: free, as far as can be seen.
  bool is_blank(uint32_t number) const;
  /// Pages that are not in use, as far as their list can be followed.
  std::vector<uint32_t> free_pages() const;
  /// Of two copies of a row the one in the page with the higher age was written last.
  uint64_t age(uint32_t number) const;

 private:
  using Page = std::vector<unsigned char>;

  bool read(uint32_t number, Page& page) const;
  void read_header();
  std::optional<SqliteRow> row_at(const Page& page, std::size_t at, PageKind kind,
                                  TreePage& tree) const;
  bool follow(uint32_t next, std::size_t left, Page& payload, TreePage& tree) const;

  std::filesystem::path file_;
  int database_ = -1;
  int log_file_ = -1;
  uint32_t page_size_ = 4096;
  uint32_t usable_ = 4096;
  uint32_t count_ = 0;
  WriteAheadLog log_;
  std::unordered_map<uint32_t, uint64_t> in_log_;  ///< the last frame of each page, from 1
  std::vector<LogFrame> frames_;
  std::optional<Header> header_;
};

}  // namespace adit
