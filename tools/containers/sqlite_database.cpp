// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/sqlite_database.hpp"

#include <sqlite3.h>

#include <cstring>
#include <system_error>
#include <utility>

#include "adit/tools/support/input_error.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

// What SQLite keeps beside a database: a rollback journal, or a write-ahead log and its index.
constexpr const char* kJournal = "-journal";
constexpr const char* kLog = "-wal";
constexpr const char* kIndex = "-shm";

/// The name by which SQLite opens a file. A relative one could be a URI or have a meaning of its
/// own, such as ":memory:".
std::string name_of(const fs::path& path) {
  std::error_code unknown;
  const fs::path absolute = fs::absolute(path, unknown);
  return unknown ? path.string() : absolute.string();
}

/// The path as SQLite's URI of a file that does not change. Before the path is an empty authority.
std::string frozen_uri(const std::filesystem::path& path) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string uri = "file://";
  for (const char letter : name_of(path)) {
    if (std::string_view("%?#").find(letter) != std::string_view::npos) {
      const auto byte = static_cast<unsigned char>(letter);
      uri += {'%', kDigits[byte >> 4U], kDigits[byte & 15U]};
    } else {
      uri += letter;
    }
  }
  return uri + "?immutable=1";
}

/// What to do where SQLite cannot read a file.
std::string remedy_of(int code) {
  switch (code) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "Another program is writing to it: wait until that has ended";
    case SQLITE_CANTOPEN:
    case SQLITE_PERM:
    case SQLITE_READONLY:
      return "Check the permissions of the file and of its folder";
    case SQLITE_NOMEM:
      return "Close other programs: the machine's memory is exhausted";
    case SQLITE_NOTADB:
      return "It is something else, or its first page is damaged: `adit run RECORDING -o OUT` "
             "makes "
             "the map OUT/map.adit, `adit recover` saves what is whole of a damaged map";
    default:
      return "The file is damaged or something else: copy it again; of a map `adit recover` saves "
             "what is whole";
  }
}

}  // namespace

void SqliteStatement::Closer::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}
void SqliteDatabase::Closer::operator()(sqlite3* database) const {
  sqlite3_close(database);
}

bool SqliteStatement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code != SQLITE_ROW && code != SQLITE_DONE) {
    database_->fail();
  }
  return code == SQLITE_ROW;
}

void SqliteStatement::reset() {
  sqlite3_reset(statement_.get());
}

int64_t SqliteStatement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

double SqliteStatement::real(int column) const {
  return sqlite3_column_double(statement_.get(), column);
}

std::string SqliteStatement::text(int column) const {
  const unsigned char* text = sqlite3_column_text(statement_.get(), column);
  return text == nullptr ? std::string() : reinterpret_cast<const char*>(text);
}

std::span<const std::byte> SqliteStatement::blob(int column) const {
  const void* data = sqlite3_column_blob(statement_.get(), column);
  const int size = sqlite3_column_bytes(statement_.get(), column);
  return {static_cast<const std::byte*>(data),
          data == nullptr ? 0 : static_cast<std::size_t>(size)};
}

SqliteStatement& SqliteStatement::bind(int parameter, int64_t value) {
  sqlite3_bind_int64(statement_.get(), parameter, value);
  return *this;
}

SqliteStatement& SqliteStatement::bind(int parameter, double value) {
  sqlite3_bind_double(statement_.get(), parameter, value);
  return *this;
}

SqliteStatement& SqliteStatement::bind(int parameter, std::string_view text) {
  sqlite3_bind_text64(statement_.get(), parameter, text.data(), text.size(), SQLITE_TRANSIENT,
                      SQLITE_UTF8);
  return *this;
}

SqliteStatement& SqliteStatement::bind(int parameter, std::span<const std::byte> blob) {
  sqlite3_bind_blob64(statement_.get(), parameter, blob.data(), blob.size(), SQLITE_TRANSIENT);
  return *this;
}

SqliteDatabase::SqliteDatabase(fs::path path, Mode mode) : path_(std::move(path)), mode_(mode) {
  if (mode == Mode::create || mode == Mode::update) {
    open(name_of(path_), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
    return;
  }
  if (mode == Mode::share) {
    // Only who may write can take away the log and its index, which reading has made, when it
    // closes last.
    open(name_of(path_), SQLITE_OPEN_READWRITE);
    execute("PRAGMA query_only = ON");
    return;
  }
  if (mode == Mode::frozen) {
    open(frozen_uri(path_), SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
    return;
  }
  open(name_of(path_), SQLITE_OPEN_READONLY);
  if (needs_recovery()) {
    open_recovered_copy();
  }
}

void SqliteDatabase::open(const std::string& name, int flags) {
  std::error_code unknown;
  if (fs::is_directory(path_, unknown)) {
    throw InputError(path_, {}, "it is a folder, not a database file",
                     "Name a file in it; of a run's folder that is map.adit");
  }
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(name.c_str(), &raw, flags, nullptr);
  database_.reset(raw);
  if (code != SQLITE_OK) {
    fail_to_open();
  }
}

/// Why SQLite cannot open the file, where that is none of the file's faults.
void SqliteDatabase::fail_to_open() const {
  const bool writes = mode_ == Mode::create || mode_ == Mode::update;
  const auto refuse = [&](const std::string& reason, const std::string& remedy) {
    if (writes) {
      throw OutputError(path_,
                        path_.string() + ": cannot be written: " + reason + ". " + remedy + ".");
    }
    throw InputError(path_, {}, reason, remedy);
  };
  std::error_code unknown;
  const std::string whole = fs::weakly_canonical(fs::absolute(path_, unknown), unknown).string();
  const auto most = static_cast<std::size_t>(sqlite3_vfs_find(nullptr)->mxPathname) -
                    std::string_view(kJournal).size();
  if (whole.size() > most) {
    refuse("its full path is " + std::to_string(whole.size()) + " bytes long, and SQLite opens " +
               std::to_string(most) + " at most",
           writes ? "Choose a shorter path" : "Move or copy it to a shorter path");
  }
  const int reason = sqlite3_system_errno(database_.get());
  if (sqlite3_errcode(database_.get()) == SQLITE_CANTOPEN && reason != 0) {
    refuse(std::string(writes ? "" : "cannot be opened: ") + std::strerror(reason),
           "Check the path, and the permissions of the file and of its folder");
  }
  fail();
}

/// A journal that was not applied yet shows at the first read, which may not write.
bool SqliteDatabase::needs_recovery() const {
  sqlite3_exec(database_.get(), "SELECT count(*) FROM sqlite_master", nullptr, nullptr, nullptr);
  const int code = sqlite3_errcode(database_.get());
  const auto is_beside = [&](const char* suffix) {
    std::error_code error;
    const auto size = fs::file_size(path_.string() + suffix, error);
    return !error && size > 0;
  };
  return (code == SQLITE_READONLY || code == SQLITE_CANTOPEN) &&
         (is_beside(kJournal) || is_beside(kLog));
}

void SqliteDatabase::open_recovered_copy() {
  database_.reset();
  copies_.push_back(make_temporary_file());
  const fs::path copy = copies_.front()->path();
  copies_.push_back(std::make_unique<UnpackedFile>(copy.string() + kIndex));
  for (const char* suffix : {"", kJournal, kLog}) {
    const fs::path from = path_.string() + suffix;
    const fs::path to = copy.string() + suffix;
    std::error_code error;
    if (*suffix != 0) {
      if (!fs::exists(from, error)) {
        continue;
      }
      copies_.push_back(std::make_unique<UnpackedFile>(to));
    }
    fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
    if (error) {
      throw OutputError(to, from.string() +
                                ": has a journal beside it that must be applied to a "
                                "copy, and " +
                                to.string() + " cannot be written: " + error.message() +
                                ". Set TMPDIR to a folder with room.");
    }
  }
  open(copy.string(), SQLITE_OPEN_READWRITE);
  execute("SELECT count(*) FROM sqlite_master");
}

SqliteStatement SqliteDatabase::prepare(const std::string& sql) const {
  sqlite3_stmt* raw = nullptr;
  if (sqlite3_prepare_v2(database_.get(), sql.c_str(), -1, &raw, nullptr) != SQLITE_OK) {
    fail();
  }
  return {*this, raw};
}

void SqliteDatabase::execute(const std::string& sql) const {
  if (sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) {
    fail();
  }
}

void SqliteDatabase::copy_to(const fs::path& file) const {
  constexpr int kAllPages = -1;
  const SqliteDatabase copy(file, Mode::create);
  sqlite3_backup* backup = sqlite3_backup_init(copy.handle(), "main", database_.get(), "main");
  if (backup == nullptr) {
    copy.fail();
  }
  const int ended = sqlite3_backup_step(backup, kAllPages);
  static_cast<void>(sqlite3_backup_finish(backup));
  if (ended == SQLITE_CORRUPT || ended == SQLITE_NOTADB) {
    fail();
  }
  if (ended != SQLITE_DONE) {
    copy.fail();
  }
}

void SqliteDatabase::fail() const {
  const std::string reason = sqlite3_errmsg(database_.get());
  const int code = sqlite3_errcode(database_.get()) & 0xff;
  const bool damaged = code == SQLITE_CORRUPT || code == SQLITE_NOTADB;
  if (!damaged && (mode_ == Mode::create || mode_ == Mode::update)) {
    throw OutputError(path_, path_.string() + ": cannot be written: " + reason +
                                 (code == SQLITE_FULL ? ". Make room there." : "."));
  }
  throw InputError(path_, {}, "cannot be read as an SQLite database: " + reason, remedy_of(code));
}

}  // namespace adit
