// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The log that SQLite keeps beside a database (FILE-wal), read frame by frame after its documented
// format, so that what SQLite passes over in silence can be told and salvaged.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace adit {

/// A page as a transaction wrote it.
struct LogFrame {
  uint32_t page = 0;    ///< of the database, counted from 1
  uint64_t offset = 0;  ///< of the page's content in the log, bytes
  bool commits = false;
};

struct WriteAheadLog {
  bool header_is_whole = true;      ///< where it is not, SQLite reads nothing of the log
  uint32_t page_size = 0;           ///< bytes; 0: there is no log, or nothing is in it
  std::vector<LogFrame> committed;  ///< what SQLite reads
  /// The first frame that is not what was written, counted from 1; nothing where no committed
  /// transaction comes after it: a writer that was killed leaves such frames.
  std::optional<uint64_t> damaged;
  /// From that frame on up to the last commit: what SQLite does not read, but for the damaged
  /// frame itself.
  std::vector<LogFrame> hidden;
  uint64_t hidden_commits = 0;
};

/// The log beside a database, empty where there is none. Throws InputError where it cannot be read.
WriteAheadLog read_log(const std::filesystem::path& database);

/// What is wrong with it, for people; empty: nothing. A writer may go on meanwhile.
std::vector<std::string> check_log(const std::filesystem::path& database);

}  // namespace adit
