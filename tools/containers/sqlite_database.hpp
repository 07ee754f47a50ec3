// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adit/tools/containers/unpacked_file.hpp"
#include "adit/tools/support/input_error.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace adit {

/// A prepared SQL statement. Columns and parameters are counted as SQLite does: columns from 0,
/// parameters from 1.
class SqliteStatement {
 public:
  /// The next row; false at the end. Throws InputError where the database is damaged, OutputError
  /// where it cannot be written.
  bool step();
  void reset();

  int64_t integer(int column) const;
  double real(int column) const;
  std::string text(int column) const;
  std::span<const std::byte> blob(int column) const;  ///< valid until the next step()

  SqliteStatement& bind(int parameter, int64_t value);
  SqliteStatement& bind(int parameter, double value);
  SqliteStatement& bind(int parameter, std::string_view text);
  SqliteStatement& bind(int parameter, std::span<const std::byte> blob);

 private:
  friend class SqliteDatabase;
  struct Closer {
    void operator()(sqlite3_stmt* statement) const;
  };
  SqliteStatement(const class SqliteDatabase& database, sqlite3_stmt* statement)
      : database_(&database), statement_(statement) {}

  const class SqliteDatabase* database_;
  std::unique_ptr<sqlite3_stmt, Closer> statement_;
};

/// An SQLite database in a file, open for as long as the object lives.
class SqliteDatabase {
 public:
  enum class Mode {
    read,    ///< the file must exist and stays as it is; see recovered()
    share,   ///< the same beside a writer; no empty log stays where none was before
    frozen,  ///< the same where nobody writes and the folder may not be written to either
    create,  ///< the file must not exist
    update,  ///< the file is made where there is none
  };
  /// Throws InputError (read, share, frozen) or OutputError (create, update).
  SqliteDatabase(std::filesystem::path path, Mode mode);

  const std::filesystem::path& path() const { return path_; }

  /// True where its last writer was killed and left a journal beside it: what is read is a copy
  /// that the journal was applied to (TMPDIR).
  bool recovered() const { return !copies_.empty(); }

  /// SQLite's own, for what is not wrapped here.
  sqlite3* handle() const { return database_.get(); }

  SqliteStatement prepare(const std::string& sql) const;
  void execute(const std::string& sql) const;

  /// All of it, as it is now, into a file that does not exist yet. Throws OutputError.
  void copy_to(const std::filesystem::path& file) const;

  /// Throws InputError or OutputError with SQLite's own words.
  [[noreturn]] void fail() const;

 private:
  struct Closer {
    void operator()(sqlite3* database) const;
  };

  void open(const std::string& name, int flags);
  [[noreturn]] void fail_to_open() const;
  bool needs_recovery() const;
  void open_recovered_copy();

  std::filesystem::path path_;
  Mode mode_;
  std::vector<std::unique_ptr<UnpackedFile>> copies_;  // outlive the connection
  std::unique_ptr<sqlite3, Closer> database_;
};

/// While it lives, all reads see the database as it was at the first of them.
class SqliteSnapshot {
 public:
  explicit SqliteSnapshot(const SqliteDatabase& database) : database_(database) {
    database_.execute("BEGIN");
  }
  ~SqliteSnapshot() {
    try {
      database_.execute("ROLLBACK");
    } catch (const FileError&) {
      // SQLite has rolled back by itself, as it does where the disk fails.
    }
  }
  SqliteSnapshot(const SqliteSnapshot&) = delete;
  SqliteSnapshot& operator=(const SqliteSnapshot&) = delete;

 private:
  const SqliteDatabase& database_;
};

/// All that is done while it lives is kept once commit() has returned, or not at all.
class SqliteTransaction {
 public:
  explicit SqliteTransaction(const SqliteDatabase& database) : database_(database) {
    database_.execute("BEGIN IMMEDIATE");
  }
  ~SqliteTransaction() {
    if (!committed_) {
      try {
        database_.execute("ROLLBACK");
      } catch (const FileError&) {
        // SQLite has rolled back by itself, as it does on a full disk.
      }
    }
  }
  SqliteTransaction(const SqliteTransaction&) = delete;
  SqliteTransaction& operator=(const SqliteTransaction&) = delete;

  void commit() {
    database_.execute("COMMIT");
    committed_ = true;
  }

 private:
  const SqliteDatabase& database_;
  bool committed_ = false;
};

}  // namespace adit
