// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/tools/containers/compression.hpp"
#include "adit/tools/containers/mcap_records.hpp"
#include "adit/tools/containers/seekable_file.hpp"

namespace adit::mcap {

/// A record of the data section, those inside chunks included.
struct Record {
  Opcode opcode = Opcode::header;
  ByteReader content;   ///< valid until the next call of Cursor::next()
  uint64_t offset = 0;  ///< byte of the file where it, or the chunk around it, begins
  bool in_chunk = false;
};

/// Walks over the records of the data section, from the first to the last, and through what the
/// chunks unpack to. Needs no index.
class Cursor {
 public:
  /// Chunks without a message of this time are passed over unread.
  explicit Cursor(const SeekableFile& file, Nanoseconds begin = Nanoseconds::min(),
                  Nanoseconds end = Nanoseconds::max());

  /// Begins at this byte of the file, where a record begins, instead of at the first.
  void start_at(uint64_t offset) { at_ = offset; }
  /// The chunks at these bytes of the file are passed over unread.
  void skip_chunks(std::set<uint64_t> offsets) { skipped_ = std::move(offsets); }

  /// The next schema, channel, message or metadata record; nothing where the data section ends.
  /// Throws InputError at a damaged place. The call after that goes on behind the damaged chunk, or
  /// finds the end where nothing tells how to go on.
  std::optional<Record> next();

  /// The compressions of the chunks seen so far.
  const std::set<std::string>& compressions() const { return compressions_; }
  /// True once the record that ends the data section was seen.
  bool complete() const { return complete_; }

 private:
  std::optional<Record> next_in_chunk();
  std::optional<Record> next_in_file();
  void open_chunk(uint64_t content, uint64_t length);
  [[noreturn]] void fail_at_end(uint64_t offset, const std::string& found);

  const SeekableFile* file_;
  Nanoseconds begin_;
  Nanoseconds end_;
  uint64_t at_ = kMagic.size();
  std::set<uint64_t> skipped_;
  bool complete_ = false;
  std::set<std::string> compressions_;
  std::vector<std::byte> packed_;  // the chunk's bytes in the file, or a record outside of chunks
  Decompressor decompressor_;
  std::span<const std::byte> records_;  // what the chunk unpacked to, as far as it is sound
  std::size_t at_in_chunk_ = 0;
  uint64_t chunk_ = 0;                      // byte of the file where the chunk begins
  std::optional<InputError> chunk_damage_;  // thrown after the chunk's sound part
};

}  // namespace adit::mcap
