// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/mcap_cursor.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "adit/tools/containers/crc32.hpp"

namespace adit::mcap {
namespace {

/// No recorder makes chunks of this size; a header that claims one is damaged.
constexpr uint64_t kLargestChunk = uint64_t{1} << 30U;
constexpr const char* kCutOff =
    "The recording was cut off, or its recorder was killed: what lies before this place can be "
    "used";

Nanoseconds to_time(uint64_t nanoseconds) {
  return Nanoseconds(static_cast<int64_t>(
      std::min<uint64_t>(nanoseconds, static_cast<uint64_t>(Nanoseconds::max().count()))));
}

bool is_wanted(Opcode opcode) {
  return opcode == Opcode::schema || opcode == Opcode::channel || opcode == Opcode::message;
}

}  // namespace

Cursor::Cursor(const SeekableFile& file, Nanoseconds begin, Nanoseconds end)
    : file_(&file), begin_(begin), end_(end) {}

void Cursor::fail_at_end(uint64_t offset, const std::string& found) {
  at_ = file_->size();
  complete_ = true;  // nothing more to say
  throw InputError(file_->path(), Place::byte(offset), found, kCutOff);
}

std::optional<Record> Cursor::next() {
  while (true) {
    if (std::optional<Record> record = next_in_chunk()) {
      return record;
    }
    if (chunk_damage_) {
      throw InputError(*std::exchange(chunk_damage_, std::nullopt));
    }
    if (complete_) {
      return std::nullopt;
    }
    if (std::optional<Record> record = next_in_file()) {
      return record;
    }
  }
}

std::optional<Record> Cursor::next_in_chunk() {
  while (at_in_chunk_ < records_.size()) {
    ByteReader reader(file_->path(), at_in_chunk_, records_.subspan(at_in_chunk_), chunk_);
    // Whatever is wrong with a record, its chunk cannot be read beyond it.
    const std::size_t whole = std::exchange(at_in_chunk_, records_.size());
    if (chunk_damage_ && reader.remaining() < kRecordHeader) {
      return std::nullopt;
    }
    const auto opcode = static_cast<Opcode>(reader.number<uint8_t>("a record"));
    const auto length = reader.number<uint64_t>("a record");
    if (chunk_damage_ && reader.remaining() < length) {
      return std::nullopt;  // cut off together with its chunk
    }
    ByteReader content = reader.part(length, "a record");
    at_in_chunk_ = whole + kRecordHeader + length;
    if (is_wanted(opcode)) {
      return Record{opcode, content, chunk_, true};
    }
  }
  return std::nullopt;
}

/// One record outside of chunks. Nothing also where it was a chunk or is of no interest.
std::optional<Record> Cursor::next_in_file() {
  const uint64_t offset = at_;
  const uint64_t left = file_->size() - std::min(offset, file_->size());
  if (left < kRecordHeader) {
    fail_at_end(offset, "the file ends where a record was expected, without the end mark of MCAP");
  }
  std::array<std::byte, kRecordHeader> head;
  file_->read(offset, head);
  ByteReader reader(file_->path(), offset, head);
  const auto opcode = static_cast<Opcode>(reader.number<uint8_t>("a record"));
  const auto length = reader.number<uint64_t>("a record");
  const uint64_t content = offset + kRecordHeader;
  if (opcode == Opcode::data_end || opcode == Opcode::footer) {
    complete_ = true;
    return std::nullopt;
  }
  const uint64_t there = std::min(length, file_->size() - content);
  if (opcode == Opcode::chunk) {
    at_ = content + there;
    open_chunk(content, length);
    return std::nullopt;
  }
  if (there < length) {
    fail_at_end(offset, "a record of " + std::to_string(length) + " bytes begins here, " +
                            std::to_string(there) + " bytes are left in the file");
  }
  at_ = content + length;
  if (!is_wanted(opcode)) {
    return std::nullopt;
  }
  if (length > kLargestChunk) {
    throw InputError(file_->path(), Place::byte(offset),
                     "a record of " + std::to_string(length) +
                         " bytes, more than the 1 GiB that "
                         "one may have here",
                     "The file is damaged: copy it again");
  }
  packed_.resize(length);
  file_->read(content, packed_);
  return Record{opcode, ByteReader(file_->path(), content, packed_), offset, false};
}

/// Makes records_ what the chunk holds; what is wrong with it goes to chunk_damage_ or is thrown.
void Cursor::open_chunk(uint64_t content, uint64_t length) {
  records_ = {};
  at_in_chunk_ = 0;
  chunk_ = content - kRecordHeader;
  const uint64_t there = std::min(length, file_->size() - content);
  const bool cut_off = there < length;
  if (cut_off) {
    complete_ = true;
  }
  const InputError cut(file_->path(), Place::byte(chunk_),
                       "a chunk of " + std::to_string(length) + " bytes begins here, " +
                           std::to_string(there) + " bytes are left in the file",
                       kCutOff);
  // The fixed fields, and more than any name of a compression needs.
  packed_.resize(std::min<uint64_t>(there, 256));
  file_->read(content, packed_);
  ChunkHeader header;
  uint64_t head_size = 0;
  try {
    ByteReader head(file_->path(), content, packed_);
    header = read_chunk_header(head);
    head_size = head.offset() - content;
  } catch (const InputError&) {
    if (cut_off) {
      throw InputError(cut);
    }
    throw;
  }
  const bool has_times = header.begin != 0 || header.end != 0;
  const bool is_outside =
      has_times && (to_time(header.end) < begin_ || to_time(header.begin) > end_);
  if (is_outside || skipped_.contains(chunk_)) {
    if (cut_off) {
      throw InputError(cut);
    }
    return;
  }
  const auto fail = [&](const std::string& found) {
    throw InputError(file_->path(), Place::byte(chunk_), found,
                     "The file is damaged: copy it again, or go without this chunk's messages");
  };
  if (!cut_off && head_size + header.packed_size > length) {
    fail("a chunk with " + std::to_string(header.packed_size) +
         " bytes of records in a record of " + std::to_string(length));
  }
  if (std::max(header.unpacked_size, header.packed_size) > kLargestChunk) {
    fail("a chunk that unpacks to " + std::to_string(header.unpacked_size) +
         " bytes, more than the 1 GiB that one may have here");
  }
  const std::optional<Compression> compression = compression_named(header.compression);
  if (!compression || *compression == Compression::bz2) {
    fail("a chunk compressed with '" + header.compression + "'; none, lz4 and zstd are known");
  }
  compressions_.emplace(to_string(*compression));
  packed_.resize(std::min(header.packed_size, there - head_size));
  file_->read(content + head_size, packed_);
  const Unpacked unpacked = decompressor_.unpack(*compression, packed_, header.unpacked_size);
  if (cut_off) {
    chunk_damage_ = cut;
    records_ = unpacked.bytes;  // sound as far as it goes: the end is missing, nothing else
    return;
  }
  if (!unpacked.problem.empty()) {
    fail("the chunk that begins here cannot be unpacked: " + unpacked.problem);
  }
  if (header.unpacked_crc != 0 && crc32(unpacked.bytes) != header.unpacked_crc) {
    fail("the check sum of the chunk that begins here does not fit its content");
  }
  records_ = unpacked.bytes;
}

}  // namespace adit::mcap
