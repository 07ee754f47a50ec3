// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A log: what is said, line by line, each with the time at which it was said.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace adit {

/// The lines of a text that comes piece by piece, as a terminal leaves them: what is drawn over
/// (carriage returns, erased lines) and colours are not in them, nor are empty lines.
class LogLines {
 public:
  /// The lines that are whole by now.
  std::vector<std::string> take(std::string_view text);
  /// What is there of the last line, when nothing more comes; may be empty.
  std::string rest();

 private:
  std::string line_;
  bool in_escape_ = false;
};

/// "2026-03-01T12:00:00.250Z", UTC.
std::string utc_text(std::chrono::system_clock::time_point time);

/// A log that is written at its end; lines that are already there stay. Each line reaches the
/// system as it is said, so that a killed program's log has all it said.
class LogFile {
 public:
  /// Makes the file if need be. Throws OutputError where it cannot be written, and where it holds
  /// anything but a log: nothing else is ever written into.
  explicit LogFile(std::filesystem::path path);
  ~LogFile();
  LogFile(const LogFile&) = delete;
  LogFile& operator=(const LogFile&) = delete;

  /// Appends a line with its time. Never throws: failure() tells of the first line that did not
  /// fit.
  void write(std::string_view line,
             std::chrono::system_clock::time_point time = std::chrono::system_clock::now());

  /// Why the log is not whole, with its path; empty while it is.
  const std::string& failure() const { return failure_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::string failure_;
};

}  // namespace adit
