// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace adit {

/// A file without a name in the system's folder for temporary files (TMPDIR): it is gone with the
/// process, however that ends. What is larger than memory lies here.
class TemporaryFile {
 public:
  /// Throws OutputError where none can be made.
  TemporaryFile();
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  /// Throws OutputError: the disk is full.
  void write(uint64_t offset, std::span<const std::byte> bytes);
  /// Fills all of `bytes`. Throws OutputError where that was never written.
  void read(uint64_t offset, std::span<std::byte> bytes) const;

 private:
  [[noreturn]] void fail(const char* attempted) const;

  std::filesystem::path folder_;
  int descriptor_ = -1;
};

}  // namespace adit
