// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

namespace adit {

/// Bytes that need not stay in memory: a file without a name in the folder of another one, which is
/// gone when the program ends, however that comes. All members throw OutputError.
class ScratchFile {
 public:
  explicit ScratchFile(std::filesystem::path beside);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  const std::filesystem::path& beside() const { return beside_; }
  uint64_t size() const { return size_; }
  void append(std::string_view bytes) { write_at(size_, bytes); }
  void write_at(uint64_t offset, std::string_view bytes);
  /// All of `bytes`, which must have been written.
  void read_at(uint64_t offset, std::span<char> bytes) const;

 private:
  [[noreturn]] void fail(std::string_view attempted) const;

  std::filesystem::path beside_;
  int file_ = -1;
  uint64_t size_ = 0;
};

}  // namespace adit
