// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/clouds/laz_writer.hpp"

#include "adit/tools/clouds/arithmetic_coder.hpp"
#include "adit/tools/clouds/laz_chunk.hpp"
#include "adit/tools/support/parallel.hpp"
#include "adit/tools/support/raw_bytes.hpp"

namespace adit {

void add_laz_record(LasRecords& records, uint32_t chunk_points, const LasPointLayout& layout) {
  std::vector<LazItem> items{{LazItemKind::point14, kLas6Bytes, 3}};
  if (layout.colored) {
    items.push_back({LazItemKind::color14, kLasColorBytes, 3});
  }
  items.push_back({LazItemKind::bytes14, static_cast<uint16_t>(layout.extra_bytes), 3});
  std::string content;
  append_raw(content, kLayeredChunks);
  append_raw(content, uint16_t{0});  // the arithmetic coder
  append_raw(content, uint8_t{3});   // the version of LASzip that has the same format
  append_raw(content, uint8_t{4});
  append_raw(content, uint16_t{3});
  append_raw(content, uint32_t{0});
  append_raw(content, chunk_points);
  append_raw(content, int64_t{-1});  // no special records
  append_raw(content, int64_t{-1});
  append_raw(content, static_cast<uint16_t>(items.size()));
  for (const LazItem& item : items) {
    append_raw(content, item.kind);
    append_raw(content, item.bytes);
    append_raw(content, item.version);
  }
  records.add(kLazUser, kLazRecord, "packed as by LASzip", content);
}

LazChunkWriter::LazChunkWriter(OutputFile& file, uint64_t begin, const LasPointLayout& layout)
    : file_(&file), begin_(begin), at_(begin + sizeof(uint64_t)), layout_(layout) {
  std::string table;
  append_raw(table, uint64_t{0});  // written when it is known
  file_->write(table);
}

std::vector<LazChunk> LazChunkWriter::write(std::span<const std::string_view> chunks) {
  std::vector<std::string> packed(chunks.size());
  in_parallel(chunks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      packed[i] = pack_laz_chunk(chunks[i], layout_);
    }
  });
  std::vector<LazChunk> written;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    file_->write(packed[i]);
    written.push_back(
        {.begin = at_, .bytes = packed[i].size(), .points = chunks[i].size() / layout_.bytes()});
    at_ += packed[i].size();
  }
  chunks_.insert(chunks_.end(), written.begin(), written.end());
  return written;
}

uint64_t LazChunkWriter::finish(LazTable table) {
  std::string bytes;
  append_raw(bytes, uint32_t{0});
  append_raw(bytes, static_cast<uint32_t>(chunks_.size()));
  if (!chunks_.empty()) {
    ArithmeticEncoder encoder;
    IntegerModel model(32, 2);
    LazChunk last;
    for (const LazChunk& chunk : chunks_) {
      if (table == LazTable::points_and_sizes) {
        model.code(encoder, static_cast<int32_t>(last.points), static_cast<int32_t>(chunk.points),
                   0);
      }
      model.code(encoder, static_cast<int32_t>(last.bytes), static_cast<int32_t>(chunk.bytes), 1);
      last = chunk;
    }
    bytes += encoder.finish();
  }
  std::string begin;
  append_raw(begin, at_);
  file_->write(bytes);
  file_->flush();
  file_->overwrite(begin_, begin);
  return at_ + bytes.size();
}

}  // namespace adit
