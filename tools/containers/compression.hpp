// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The compressions that chunks of recordings come in: LZ4 and Zstandard frames, bzip2 streams.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace adit {

enum class Compression { none, lz4, zstd, bz2 };
std::string_view to_string(Compression compression);

/// By the name that containers give it; "" and "none" are none.
std::optional<Compression> compression_named(std::string_view name);

/// What came out of packed bytes.
struct Unpacked {
  std::span<const std::byte> bytes;  ///< valid until the next call
  bool cut_off = false;  ///< the packed bytes ended early; `bytes` is what they held until there
  std::string problem;   ///< for people: what is wrong, empty where all is well
};

/// Unpacks chunk after chunk into one buffer that is used again.
class Decompressor {
 public:
  /// Unpacks what should become `size` bytes. A size that lies takes no memory: the buffer grows
  /// with what really comes out, and never beyond `size`.
  Unpacked unpack(Compression compression, std::span<const std::byte> packed, uint64_t size);

 private:
  std::vector<std::byte> buffer_;
};

/// What a Zstandard frame says it unpacks to (bytes); nothing where it does not say or is none.
std::optional<uint64_t> zstd_content_size(std::span<const std::byte> frame);

/// Packs with the library's default level. Throws std::runtime_error where the library fails.
std::vector<std::byte> compress(Compression compression, std::span<const std::byte> bytes);

}  // namespace adit
