// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "adit/tools/support/input_error.hpp"

namespace adit {

/// Another process writes to the same file: what() names it.
class LockedError : public FileError {
 public:
  using FileError::FileError;
};

/// While it lives, no other one of the same file does, in whatever process. The system takes it
/// back from a process that ends, however it ends.
class WriterLock {
 public:
  /// Makes FILE.lock, which says who holds it. Throws LockedError, or OutputError where the folder
  /// cannot be written to.
  explicit WriterLock(const std::filesystem::path& file);
  ~WriterLock();
  WriterLock(const WriterLock&) = delete;
  WriterLock& operator=(const WriterLock&) = delete;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

/// Who has the lock of a file at this moment ("process 4711 on mallard"); nothing where nobody has.
std::optional<std::string> writer_of(const std::filesystem::path& file);

}  // namespace adit
