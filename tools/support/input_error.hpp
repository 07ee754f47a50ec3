// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What is wrong with a file, for people: which file, where in it, what was found, what to do.
#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

namespace adit {

/// A file that cannot be used. what() is the whole message; file() names the culprit.
class FileError : public std::runtime_error {
 public:
  /// `message` is the whole of what(), for people.
  FileError(std::filesystem::path file, const std::string& message)
      : std::runtime_error(message), file_(std::move(file)) {}

  /// The file that cannot be used.
  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
};

/// A place in a file, for InputError. Default: the file as a whole.
class Place {
 public:
  Place() = default;
  static Place line(uint64_t number);         ///< counted from 1
  static Place byte(uint64_t offset);         ///< counted from 0
  static Place point(uint64_t index);         ///< counted from 0
  static Place named(std::string_view name);  ///< e.g. "header field WIDTH"

  /// For people: "line 3", "byte 96", or nothing.
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// Data that cannot be read. what() is one paragraph: "FILE, PLACE: FOUND. REMEDY."
class InputError : public FileError {
 public:
  /// `found` says what was found and what was expected; `remedy` what to do about it.
  InputError(const std::filesystem::path& file, const Place& place, std::string found,
             std::string remedy);

  /// Where in the file; empty: the file as a whole.
  const std::string& place() const { return place_; }
  /// What was found there.
  const std::string& found() const { return found_; }
  /// What to do about it.
  const std::string& remedy() const { return remedy_; }

 private:
  std::string place_;
  std::string found_;
  std::string remedy_;
};

/// A result that cannot be written: what() holds the path and the system's reason.
/// A file that cannot be written.
class OutputError : public FileError {
 public:
  using FileError::FileError;
};

}  // namespace adit
