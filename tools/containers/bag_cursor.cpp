// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/bag_cursor.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace adit::bag {
namespace {

/// No recorder makes chunks or headers of these sizes; what claims one is damaged.
constexpr uint64_t kLargestChunk = uint64_t{1} << 30U;
constexpr uint64_t kLargestHeader = uint64_t{1} << 20U;
constexpr const char* kCutOff =
    "The bag was cut off, or its recorder was killed: what lies before this place can be used";

}  // namespace

Cursor::Cursor(const SeekableFile& file, bool closed) : file_(&file), end_is_known_(closed) {}

void Cursor::fail_at_end(uint64_t offset, const std::string& found) {
  at_ = file_->size();
  end_is_known_ = true;
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
    if (at_ >= file_->size()) {
      if (!end_is_known_) {
        fail_at_end(file_->size(), "the bag ends here without its index");
      }
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
    const std::size_t begin = at_in_chunk_;
    const std::size_t size = reader.remaining();
    // Whatever is wrong with a record, its chunk cannot be read beyond it.
    at_in_chunk_ = records_.size();
    try {
      const auto header_length = reader.number<uint32_t>("the header of a record");
      const Fields header(reader.part(header_length, "the header of a record"));
      const auto data_length = reader.number<uint32_t>("the data of a record");
      const ByteReader data = reader.part(data_length, "the data of a record");
      at_in_chunk_ = begin + (size - reader.remaining());
      const std::optional<Opcode> opcode = header.opcode();
      if (opcode == Opcode::connection || opcode == Opcode::message) {
        return Record{*opcode, header, data, chunk_, true};
      }
    } catch (const InputError&) {
      if (!chunk_damage_) {
        throw;
      }
      return std::nullopt;  // cut off together with its chunk
    }
  }
  return std::nullopt;
}

/// One record outside of chunks. Nothing also where it was a chunk or is of no interest.
std::optional<Record> Cursor::next_in_file() {
  const uint64_t offset = at_;
  const auto number_at = [&](uint64_t at) {
    if (file_->size() < at || file_->size() - at < sizeof(uint32_t)) {
      fail_at_end(offset, "the file ends in the record that begins here");
    }
    std::array<std::byte, sizeof(uint32_t)> bytes;
    file_->read(at, bytes);
    return uint64_t{ByteReader(file_->path(), at, bytes).number<uint32_t>("a length")};
  };
  const uint64_t header_length = number_at(offset);
  const uint64_t header_at = offset + sizeof(uint32_t);
  if (header_length > kLargestHeader) {
    fail_at_end(offset, "a record begins here whose header claims " +
                            std::to_string(header_length) + " bytes");
  }
  const uint64_t data_length = number_at(header_at + header_length);
  const uint64_t data_at = header_at + header_length + sizeof(uint32_t);
  head_.resize(header_length);
  file_->read(header_at, head_);
  at_ = file_->size();  // where the header makes no sense, nothing tells how to go on
  const Fields header(ByteReader(file_->path(), header_at, head_));
  const std::optional<Opcode> opcode = header.opcode();
  const uint64_t there = std::min(data_length, file_->size() - data_at);
  at_ = data_at + there;
  if (opcode == Opcode::chunk) {
    chunk_ = offset;
    open_chunk(header, data_at, data_length);
    return std::nullopt;
  }
  if (there < data_length) {
    fail_at_end(offset, "a record with " + std::to_string(data_length) +
                            " bytes of data begins here, " + std::to_string(there) +
                            " bytes are left in the file");
  }
  if (opcode != Opcode::connection && opcode != Opcode::message) {
    return std::nullopt;
  }
  if (data_length > kLargestChunk) {
    throw InputError(file_->path(), Place::byte(offset),
                     "a record of " + std::to_string(data_length) +
                         " bytes, more than the 1 GiB that one may have here",
                     "The file is damaged: copy it again");
  }
  packed_.resize(data_length);
  file_->read(data_at, packed_);
  return Record{*opcode, header, ByteReader(file_->path(), data_at, packed_), offset, false};
}

/// Makes records_ what the chunk holds; what is wrong with it goes to chunk_damage_ or is thrown.
void Cursor::open_chunk(const Fields& header, uint64_t data_at, uint64_t length) {
  records_ = {};
  at_in_chunk_ = 0;
  const uint64_t there = std::min(length, file_->size() - data_at);
  const bool cut_off = there < length;
  end_is_known_ = end_is_known_ || cut_off;
  const InputError cut(file_->path(), Place::byte(chunk_),
                       "a chunk of " + std::to_string(length) + " bytes begins here, " +
                           std::to_string(there) + " bytes are left in the file",
                       kCutOff);
  if (skipped_.contains(chunk_)) {
    if (cut_off) {
      throw InputError(cut);
    }
    return;
  }
  const auto fail = [&](const std::string& found) {
    throw InputError(file_->path(), Place::byte(chunk_), found,
                     "The file is damaged: copy it again, or go without this chunk's messages");
  };
  const uint64_t unpacked_size = header.number<uint32_t>("size");
  if (std::max(unpacked_size, length) > kLargestChunk) {
    fail("a chunk that unpacks to " + std::to_string(unpacked_size) +
         " bytes, more than the 1 GiB that one may have here");
  }
  const std::string name = header.text("compression");
  const std::optional<Compression> compression = compression_named(name);
  if (!compression || *compression == Compression::zstd) {
    fail("a chunk compressed with '" + name + "'; none, bz2 and lz4 are known");
  }
  compressions_.emplace(to_string(*compression));
  packed_.resize(there);
  file_->read(data_at, packed_);
  const Unpacked unpacked = decompressor_.unpack(*compression, packed_, unpacked_size);
  if (cut_off) {
    chunk_damage_ = cut;
  } else if (!unpacked.problem.empty()) {
    fail("the chunk that begins here cannot be unpacked: " + unpacked.problem);
  }
  records_ = unpacked.bytes;
}

}  // namespace adit::bag
