// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "adit/tools/support/input_error.hpp"

namespace adit {

/// A regular file of any size, read here and there. Its size is that at the time of opening.
class SeekableFile {
 public:
  /// Throws InputError: missing, not a file, not readable.
  explicit SeekableFile(std::filesystem::path path);
  ~SeekableFile();
  SeekableFile(const SeekableFile&) = delete;
  SeekableFile& operator=(const SeekableFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  uint64_t size() const { return size_; }

  /// Fills `into` from byte `offset` on. Throws InputError where the file ends before that, or the
  /// disk fails.
  void read(uint64_t offset, std::span<std::byte> into) const;

  /// The same as a vector; memory is taken only where the file has that many bytes.
  std::vector<std::byte> read(uint64_t offset, uint64_t bytes) const;

 private:
  void require(uint64_t offset, uint64_t bytes) const;

  std::filesystem::path path_;
  int descriptor_ = -1;
  uint64_t size_ = 0;
};

}  // namespace adit
