// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Format: https://www.sqlite.org/fileformat2.html.
#include "adit/tools/map_database/sqlite_pages.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFileMagic{"SQLite format 3\0", 16};
constexpr std::size_t kFileHeader = 100;  // before the tree in page 1

using Page = std::vector<unsigned char>;

uint64_t big_endian(const Page& bytes, std::size_t at, std::size_t count) {
  uint64_t value = 0;
  for (std::size_t i = at; i < at + count; ++i) {
    value = value << 8U | bytes[i];
  }
  return value;
}

uint32_t word(const Page& bytes, std::size_t at) {
  return static_cast<uint32_t>(big_endian(bytes, at, 4));
}

/// SQLite's numbers of 1 to 9 bytes. Moves `at` on; false where they go beyond `end`.
bool varint(const Page& bytes, std::size_t end, std::size_t& at, uint64_t& value) {
  value = 0;
  for (int i = 0; i < 9 && at < end; ++i) {
    const unsigned char byte = bytes[at++];
    if (i == 8) {
      value = value << 8U | byte;
      return true;
    }
    value = value << 7U | (byte & 0x7fU);
    if ((byte & 0x80U) == 0) {
      return true;
    }
  }
  return false;
}

bool is_leaf(PageKind kind) {
  return kind == PageKind::index_leaf || kind == PageKind::table_leaf;
}
bool is_index(PageKind kind) {
  return kind == PageKind::index_leaf || kind == PageKind::index_inside;
}

PageKind kind_of(unsigned char flags) {
  switch (flags) {
    case 2:
      return PageKind::index_inside;
    case 5:
      return PageKind::table_inside;
    case 10:
      return PageKind::index_leaf;
    case 13:
      return PageKind::table_leaf;
    default:
      return PageKind::none;
  }
}

/// A tree's page as its header describes it, which has been checked.
struct TreeHeader {
  PageKind kind = PageKind::none;
  std::size_t cells = 0;
  std::size_t pointers = 0;  ///< where they begin
  uint32_t last_child = 0;
};

TreeHeader tree_header(const Page& page, std::size_t usable, uint32_t number) {
  const std::size_t start = number == 1 ? kFileHeader : 0;
  TreeHeader header{.kind = kind_of(page[start]), .cells = big_endian(page, start + 3, 2)};
  header.pointers = start + (is_leaf(header.kind) ? 8 : 12);
  const std::size_t content = big_endian(page, start + 5, 2);
  const std::size_t pointers_end = header.pointers + 2 * header.cells;
  if (header.kind == PageKind::none || pointers_end > usable ||
      (content != 0 && content < pointers_end) || content > usable || page[start + 7] > 60) {
    return {};
  }
  if (!is_leaf(header.kind)) {
    header.last_child = word(page, start + 8);
  }
  return header;
}

/// A value of a record; false where the bytes end before it.
bool value_of(const Page& bytes, uint64_t type, std::size_t& at, SqliteValue& value) {
  constexpr std::size_t kSizes[] = {0, 1, 2, 3, 4, 6, 8, 8, 0, 0};
  if (type == 10 || type == 11) {
    return false;
  }
  const uint64_t size = type < 10 ? kSizes[type] : (type - 12) / 2;
  if (at > bytes.size() || size > bytes.size() - at) {
    return false;
  }
  if (type == 0) {
    value = std::monostate();
  } else if (type == 8 || type == 9) {
    value = static_cast<int64_t>(type - 8);
  } else if (type < 8) {
    uint64_t bits = big_endian(bytes, at, size);
    if (type == 7) {
      value = std::bit_cast<double>(bits);
    } else {
      const std::size_t unused = 64 - 8 * size;
      value = static_cast<int64_t>(bits << unused) >> unused;
    }
  } else if (type % 2 == 0) {
    std::vector<std::byte> blob(size);
    if (size > 0) {
      std::memcpy(blob.data(), bytes.data() + at, size);
    }
    value = std::move(blob);
  } else {
    value = std::string(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                        bytes.begin() + static_cast<std::ptrdiff_t>(at + size));
  }
  at += size;
  return true;
}

/// The values of a record, which has to be one to its last byte.
std::optional<std::vector<SqliteValue>> record_of(const Page& bytes) {
  std::size_t type_at = 0;
  uint64_t header = 0;
  if (!varint(bytes, bytes.size(), type_at, header) || header > bytes.size()) {
    return std::nullopt;
  }
  std::vector<SqliteValue> values;
  std::size_t at = header;
  while (type_at < header) {
    uint64_t type = 0;
    SqliteValue value;
    if (!varint(bytes, header, type_at, type) || !value_of(bytes, type, at, value)) {
      return std::nullopt;
    }
    values.push_back(std::move(value));
  }
  return at == bytes.size() ? std::optional(std::move(values)) : std::nullopt;
}

}  // namespace

SqlitePages::SqlitePages(const fs::path& file) : file_(file), log_(read_log(file)) {
  database_ = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (database_ < 0) {
    throw InputError(file, {}, std::string("cannot be read: ") + std::strerror(errno),
                     "Name a map that `adit run` has made");
  }
  log_file_ = ::open((file.string() + "-wal").c_str(), O_RDONLY | O_CLOEXEC);
  frames_ = log_.committed;
  frames_.insert(frames_.end(), log_.hidden.begin(), log_.hidden.end());
  page_size_ = log_.page_size > 0 ? log_.page_size : page_size_;
  usable_ = page_size_;
  std::error_code error;
  const uintmax_t bytes = fs::file_size(file, error);
  // Pages beyond the file are all in the log: a frame of one further on is none.
  const uintmax_t most = (error ? 0 : bytes / page_size_) + frames_.size();
  uint32_t last = 0;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (frames_[i].page <= most) {
      in_log_[frames_[i].page] = i + 1;
      last = std::max(last, frames_[i].page);
    }
  }
  read_header();
  count_ = std::max(error ? 0U : static_cast<uint32_t>(bytes / page_size_), last);
}

SqlitePages::~SqlitePages() {
  ::close(database_);
  if (log_file_ >= 0) {
    ::close(log_file_);
  }
}

void SqlitePages::read_header() {
  Page page;
  if (!read(1, page) ||
      !std::equal(kFileMagic.begin(), kFileMagic.end(), page.begin(),
                  [](char a, unsigned char b) { return static_cast<unsigned char>(a) == b; })) {
    return;
  }
  const auto size = static_cast<uint32_t>(big_endian(page, 16, 2));
  const uint32_t page_size = size == 1 ? 65536 : size;
  if (!std::has_single_bit(page_size) || page_size < 512 || page[20] > page_size - 480) {
    return;
  }
  page_size_ = log_.page_size > 0 ? page_size_ : page_size;
  usable_ = page_size_ - page[20];
  header_ = {.application = word(page, 68),
             .version = static_cast<int32_t>(word(page, 60)),
             .pages = word(page, 28),
             .first_free = word(page, 32)};
}

bool SqlitePages::read(uint32_t number, Page& page) const {
  if (number == 0) {
    return false;
  }
  const auto logged = in_log_.find(number);
  const bool is_logged = logged != in_log_.end();
  const uint64_t offset =
      is_logged ? frames_[logged->second - 1].offset : uint64_t{number - 1} * page_size_;
  page.resize(page_size_);
  return ::pread(is_logged ? log_file_ : database_, page.data(), page.size(),
                 static_cast<off_t>(offset)) == static_cast<ssize_t>(page.size());
}

uint64_t SqlitePages::age(uint32_t number) const {
  const auto logged = in_log_.find(number);
  return logged == in_log_.end() ? 0 : logged->second;
}

PageKind SqlitePages::kind(uint32_t number) const {
  Page page;
  return read(number, page) ? tree_header(page, usable_, number).kind : PageKind::none;
}

bool SqlitePages::is_blank(uint32_t number) const {
  Page page;
  return read(number, page) && std::ranges::all_of(page, [](unsigned char b) { return b == 0; });
}

std::vector<uint32_t> SqlitePages::free_pages() const {
  std::vector<uint32_t> pages;
  uint32_t trunk = header_ ? header_->first_free : 0;
  Page page;
  while (trunk != 0 && trunk <= count_ && pages.size() <= count_ && read(trunk, page)) {
    pages.push_back(trunk);
    const uint32_t leaves = word(page, 4);
    if (leaves > usable_ / 4 - 2) {
      break;
    }
    for (uint32_t i = 0; i < leaves; ++i) {
      pages.push_back(word(page, 8 + 4 * std::size_t{i}));
    }
    trunk = word(page, 0);
  }
  return pages;
}

TreePage SqlitePages::tree_page(uint32_t number) const {
  TreePage tree;
  Page page;
  if (!read(number, page)) {
    return tree;
  }
  const TreeHeader header = tree_header(page, usable_, number);
  tree.kind = header.kind;
  for (std::size_t i = 0; i < header.cells; ++i) {
    std::size_t at = big_endian(page, header.pointers + 2 * i, 2);
    if (at < header.pointers + 2 * header.cells || at + 4 > usable_) {
      tree.damaged = true;
      continue;
    }
    if (!is_leaf(header.kind)) {
      tree.children.push_back(word(page, at));
      at += 4;
    }
    if (header.kind == PageKind::table_inside) {
      uint64_t rowid = 0;
      tree.damaged = !varint(page, usable_, at, rowid) || tree.damaged;
      tree.last_rowids.push_back(static_cast<int64_t>(rowid));
    } else if (std::optional<SqliteRow> row = row_at(page, at, header.kind, tree)) {
      tree.rows.push_back(std::move(*row));
    }
  }
  if (header.kind != PageKind::none && !is_leaf(header.kind)) {
    tree.children.push_back(header.last_child);
  }
  return tree;
}

std::optional<SqliteRow> SqlitePages::row_at(const Page& page, std::size_t at, PageKind kind,
                                             TreePage& tree) const {
  SqliteRow row;
  uint64_t size = 0;
  uint64_t rowid = 0;
  if (!varint(page, usable_, at, size) || size > uint64_t{count_} * usable_ ||
      (!is_index(kind) && !varint(page, usable_, at, rowid))) {
    tree.damaged = true;
    return std::nullopt;
  }
  row.rowid = static_cast<int64_t>(rowid);
  // What does not fit goes on in a chain of other pages.
  const std::size_t most =
      is_index(kind) ? (usable_ - 12) * std::size_t{64} / 255 - 23 : usable_ - std::size_t{35};
  std::size_t local = size;
  if (size > most) {
    const std::size_t least = (usable_ - 12) * std::size_t{32} / 255 - 23;
    const std::size_t fitting = least + (size - least) % (usable_ - 4);
    local = fitting <= most ? fitting : least;
  }
  if (at + local + (size > local ? 4 : 0) > usable_) {
    tree.damaged = true;
    return std::nullopt;
  }
  Page payload(page.begin() + static_cast<std::ptrdiff_t>(at),
               page.begin() + static_cast<std::ptrdiff_t>(at + local));
  if (size > local && !follow(word(page, at + local), size - local, payload, tree)) {
    tree.damaged_rowids.push_back(row.rowid);
    return std::nullopt;
  }
  std::optional<std::vector<SqliteValue>> values = record_of(payload);
  if (!values) {
    tree.damaged = true;
    return std::nullopt;
  }
  row.values = std::move(*values);
  return row;
}

// The last page of a chain names none: a number there shows that it is another page.
bool SqlitePages::follow(uint32_t next, std::size_t left, Page& payload, TreePage& tree) const {
  Page page;
  while (left > 0) {
    if (next > count_ || !read(next, page)) {
      return false;
    }
    tree.overflow.push_back(next);
    const std::size_t part = std::min<std::size_t>(left, usable_ - 4);
    payload.insert(payload.end(), page.begin() + 4,
                   page.begin() + 4 + static_cast<std::ptrdiff_t>(part));
    left -= part;
    next = word(page, 0);
  }
  return next == 0;
}

}  // namespace adit
