// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "adit/tools/containers/bag_records.hpp"
#include "adit/tools/containers/compression.hpp"
#include "adit/tools/containers/seekable_file.hpp"

namespace adit::bag {

/// A record with the place of the file where it, or the chunk around it, begins.
struct Record {
  Opcode opcode = Opcode::message;
  Fields header;
  ByteReader data;  ///< valid until the next call of Cursor::next()
  uint64_t offset = 0;
  bool in_chunk = false;
};

/// Walks over the messages and connections of a bag, from the first to the last, and through what
/// the chunks unpack to. Needs no index.
class Cursor {
 public:
  /// `closed`: the bag has its index. Without it, the end is reported as that of a recorder that
  /// was killed.
  Cursor(const SeekableFile& file, bool closed);

  /// The chunks at these bytes of the file are passed over unread.
  void skip_chunks(std::set<uint64_t> offsets) { skipped_ = std::move(offsets); }

  /// Begins at this byte of the file, where a record begins, instead of at the first.
  void start_at(uint64_t offset) { at_ = offset; }

  /// The next connection or message; nothing at the end. Throws InputError at a damaged place. The
  /// call after that goes on behind the damaged chunk, or finds the end where nothing tells how to
  /// go on.
  std::optional<Record> next();

  /// The compressions of the chunks seen so far.
  const std::set<std::string>& compressions() const { return compressions_; }

 private:
  std::optional<Record> next_in_chunk();
  std::optional<Record> next_in_file();
  void open_chunk(const Fields& header, uint64_t data_at, uint64_t length);
  [[noreturn]] void fail_at_end(uint64_t offset, const std::string& found);

  const SeekableFile* file_;
  bool end_is_known_;  // nothing to complain about there
  uint64_t at_ = kMagic.size();
  std::set<uint64_t> skipped_;
  std::set<std::string> compressions_;
  std::vector<std::byte> head_;    // the header of the record at hand
  std::vector<std::byte> packed_;  // its data, or the chunk's bytes in the file
  Decompressor decompressor_;
  std::span<const std::byte> records_;  // what the chunk unpacked to, as far as it is sound
  std::size_t at_in_chunk_ = 0;
  uint64_t chunk_ = 0;                      // byte of the file where the chunk begins
  std::optional<InputError> chunk_damage_;  // thrown after the chunk's sound part
};

}  // namespace adit::bag
