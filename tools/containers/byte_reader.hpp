// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Numbers and texts out of the records of a container file, and into them. Both containers (MCAP,
// ROS 1 bags) are little-endian.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "adit/tools/support/input_error.hpp"

namespace adit {

static_assert(std::endian::native == std::endian::little, "records are read as they lie");

/// Walks over a piece of a file. What runs over its end is an InputError with the place.
class ByteReader {
 public:
  /// `bytes` lie in `file` at `offset`; or, where `chunk` is given, at `offset` of what the chunk
  /// at that byte of the file unpacks to. `file` must outlive the reader.
  ByteReader(const std::filesystem::path& file, uint64_t offset, std::span<const std::byte> bytes,
             std::optional<uint64_t> chunk = std::nullopt)
      : file_(&file), base_(offset), bytes_(bytes), chunk_(chunk) {}

  std::size_t remaining() const { return bytes_.size() - at_; }
  uint64_t offset() const { return base_ + at_; }

  template <class T>
  requires std::is_arithmetic_v<T> T number(std::string_view what) {
    T value;
    std::memcpy(&value, bytes(sizeof(T), what).data(), sizeof(T));
    return value;
  }

  std::span<const std::byte> bytes(uint64_t count, std::string_view what) {
    if (count > remaining()) {
      fail(std::string(what) + " needs " + std::to_string(count) + " bytes, " +
           std::to_string(remaining()) + " are left");
    }
    const std::span<const std::byte> taken = bytes_.subspan(at_, count);
    at_ += count;
    return taken;
  }

  /// A 32-bit length and as many bytes.
  std::string text(std::string_view what) {
    const auto length = number<uint32_t>(what);
    const std::span<const std::byte> taken = bytes(length, what);
    return {reinterpret_cast<const char*>(taken.data()), taken.size()};
  }

  /// The next `count` bytes as a reader of their own.
  ByteReader part(uint64_t count, std::string_view what) {
    const uint64_t begin = offset();
    return {*file_, begin, bytes(count, what), chunk_};
  }

  /// Throws InputError at the current place.
  [[noreturn]] void fail(const std::string& found) const {
    const std::string at = chunk_ ? "byte " + std::to_string(offset()) +
                                        " of what the chunk at byte " + std::to_string(*chunk_) +
                                        " unpacks to"
                                  : "byte " + std::to_string(offset());
    throw InputError(*file_, Place::named(at), found,
                     "The file is damaged: copy it again, or use what lies before this place");
  }

 private:
  const std::filesystem::path* file_;
  uint64_t base_;
  std::span<const std::byte> bytes_;
  std::optional<uint64_t> chunk_;
  std::size_t at_ = 0;
};

/// Puts a record together.
class ByteWriter {
 public:
  template <class T>
  requires std::is_arithmetic_v<T>
  void number(T value) { append(&value, sizeof(T)); }
  void bytes(std::span<const std::byte> data) { append(data.data(), data.size()); }
  /// A 32-bit length and the bytes.
  void text(std::string_view text) {
    number(static_cast<uint32_t>(text.size()));
    append(text.data(), text.size());
  }

  std::span<const std::byte> content() const { return bytes_; }
  std::size_t size() const { return bytes_.size(); }
  void clear() { bytes_.clear(); }

 private:
  void append(const void* data, std::size_t size);

  std::vector<std::byte> bytes_;
};

}  // namespace adit
