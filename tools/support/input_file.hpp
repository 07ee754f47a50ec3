// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Whole files into memory, and the numbers in text files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/support/input_error.hpp"

namespace adit {

/// A regular file that is open for reading, with its size. Files beyond 2 GiB are refused: no sweep
/// and no trajectory is that long.
class InputFile {
 public:
  /// Throws InputError: missing, not a file, not readable, too large.
  explicit InputFile(std::filesystem::path path);

  std::size_t size() const { return size_; }

  /// Fills `bytes` bytes from the file's current position. Throws InputError where the file ends
  /// early.
  void read(void* into, std::size_t bytes);

 private:
  struct Closer {
    void operator()(std::FILE* file) const { static_cast<void>(std::fclose(file)); }
  };

  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Closer> file_;
  std::size_t size_ = 0;
};

/// The whole file, byte for byte. Throws InputError as InputFile does.
std::string read_whole_file(const std::filesystem::path& path);

/// Where the text of a file starts: after a byte order mark of UTF-8, if there is one. `head` is
/// the start of the file. Throws InputError where it is text in UTF-16 or UTF-32.
std::size_t start_of_text(const std::filesystem::path& path, std::string_view head);

/// The text of a file, without a byte order mark. Throws InputError as InputFile and
/// start_of_text() do.
std::string read_text_file(const std::filesystem::path& path);

/// A text file to be read line by line, after a byte order mark. Throws InputError where it cannot
/// be opened, and as start_of_text() does.
std::ifstream open_text_file(const std::filesystem::path& path);

/// Walks over the lines of a text; line ends are LF or CRLF.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : text_(text) {}

  /// The next line without its end, or nothing at the end of the text.
  std::optional<std::string_view> next();

  uint64_t number() const { return number_; }     ///< number of the line last returned, from 1
  std::size_t offset() const { return offset_; }  ///< first byte after it
  std::string_view rest() const { return text_.substr(offset_); }

 private:
  std::string_view text_;
  std::size_t offset_ = 0;
  uint64_t number_ = 0;
};

/// The line's words, separated by blanks and tabs.
std::vector<std::string_view> split_words(std::string_view line);

/// The line's words into `words`, at most its size. Returns how many words the line has.
std::size_t split_words(std::string_view line, std::span<std::string_view> words);

/// The line up to a '#'.
std::string_view without_comment(std::string_view line);

/// A number that fills the whole word ("nan" and "inf" count). Does not depend on the locale.
std::optional<double> parse_double(std::string_view word);

/// A non-negative integer that fills the whole word.
std::optional<uint64_t> parse_unsigned(std::string_view word);

/// Seconds, exact to the nanosecond where written without exponent ("1623370000.123456789"). Empty
/// where it is no finite number or does not fit 64 bits of nanoseconds.
std::optional<Nanoseconds> parse_seconds(std::string_view word);

/// A number of seconds as nanoseconds; empty where it is not finite or does not fit.
std::optional<Nanoseconds> to_nanoseconds(double seconds);

/// A word of a file for a message: shortened, and what cannot be printed replaced.
std::string in_quotes(std::string_view word);

}  // namespace adit
