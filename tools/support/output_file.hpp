// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A file that is written and never silently short: every write, flush and the close are checked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

#include "adit/slam/core/types.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {

/// Writes through a buffer. Each member throws OutputError with the path and the system's reason.
/// The destructor closes without a report: call close() where the file must be whole.
class OutputFile {
 public:
  /// Creates or empties the file. Its folder must exist.
  explicit OutputFile(std::filesystem::path path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(const void* data, std::size_t bytes);
  void write(std::string_view text) { write(text.data(), text.size()); }

  /// Writes over bytes that are already there, then goes on at the end.
  void overwrite(uint64_t offset, std::string_view text);

  /// Hands everything to the operating system, so that other programs see it.
  void flush();

  /// Flushes and closes. Nothing may be written after it; a second call does nothing.
  void close();

  const std::filesystem::path& path() const { return path_; }

 private:
  [[noreturn]] void fail(std::string_view attempted) const;

  std::filesystem::path path_;
  std::FILE* file_ = nullptr;
};

/// FILE.part, which takes FILE's place once it is whole. Where it does not come to that it is
/// removed: it would keep a full disk full.
class Draft {
 public:
  static std::filesystem::path path_of(const std::filesystem::path& file);

  explicit Draft(std::filesystem::path file);
  ~Draft();
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Throws OutputError.
  void take_its_place();

 private:
  std::filesystem::path file_;
  std::filesystem::path path_;
};

/// Writes a whole text file. Throws OutputError.
void write_text_file(const std::filesystem::path& path, std::string_view text);

/// The new text replaces the old file whole or not at all. On a full disk there is no room for
/// both: then it is written over the old one, and where it does not fit there, the old one is put
/// back. Throws OutputError.
void replace_text_file(const std::filesystem::path& path, const std::string& text);

/// Appends a number: the shortest text that reads back to the same double, whatever the locale.
void append_number(std::string& line, double value);

/// Appends "SECONDS.NNNNNNNNN", exact.
void append_stamp(std::string& line, Nanoseconds stamp);

}  // namespace adit
