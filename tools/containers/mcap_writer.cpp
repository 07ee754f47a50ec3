// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/mcap_writer.hpp"

#include <algorithm>
#include <stdexcept>

#include "adit/tools/containers/crc32.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

using mcap::Opcode;

/// The opcode, the length and the content of a record.
ByteWriter record(Opcode opcode, const ByteWriter& content) {
  ByteWriter whole;
  whole.number(static_cast<uint8_t>(opcode));
  whole.number(static_cast<uint64_t>(content.size()));
  whole.bytes(content.content());
  return whole;
}

std::string text_of(const ByteWriter& bytes) {
  return {reinterpret_cast<const char*>(bytes.content().data()), bytes.size()};
}

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& path, const McapOptions& options)
    : file_(path), options_(options) {
  file_.write(mcap::kMagic.data(), mcap::kMagic.size());
  offset_ = mcap::kMagic.size();
  ByteWriter header;
  header.text(options.profile);
  header.text("adit " + std::string(version()));
  put(record(Opcode::header, header));
}

void McapWriter::put(const ByteWriter& record) {
  file_.write(record.content().data(), record.size());
  offset_ += record.size();
}

std::size_t McapWriter::add_channel(const Channel& channel) {
  if (channel.encoding == Encoding::other) {
    throw std::logic_error("MCAP: the encoding of " + channel.topic + " is not known");
  }
  const bool ros2 = channel.encoding == Encoding::cdr;
  return add_channel(channel.topic,
                     {.name = ros2 ? ros2_type_name(channel.type) : channel.type,
                      .encoding = ros2 ? "ros2msg" : "ros1msg",
                      .data = channel.definition,
                      .message_encoding = ros2 ? "cdr" : "ros1"},
                     channel.metadata);
}

std::size_t McapWriter::add_channel(const std::string& topic, const McapSchema& schema,
                                    const std::map<std::string, std::string>& metadata) {
  const auto [known, added] = schemas_.try_emplace({schema.name, schema.encoding},
                                                   static_cast<uint16_t>(schemas_.size() + 1));
  if (added) {
    ByteWriter content;
    content.number(known->second);
    content.text(schema.name);
    content.text(schema.encoding);
    content.text(schema.data);
    schema_records_.push_back(text_of(record(Opcode::schema, content)));
    file_.write(schema_records_.back());
    offset_ += schema_records_.back().size();
  }
  const auto id = static_cast<uint16_t>(counts_.size());
  ByteWriter pairs;
  for (const auto& [key, value] : metadata) {
    pairs.text(key);
    pairs.text(value);
  }
  ByteWriter content;
  content.number(id);
  content.number(known->second);
  content.text(topic);
  content.text(schema.message_encoding);
  content.number(static_cast<uint32_t>(pairs.size()));
  content.bytes(pairs.content());
  channel_records_.push_back(text_of(record(Opcode::channel, content)));
  file_.write(channel_records_.back());
  offset_ += channel_records_.back().size();
  counts_.push_back(0);
  return id;
}

void McapWriter::write(std::size_t channel, Nanoseconds received,
                       std::span<const std::byte> bytes) {
  const auto id = static_cast<uint16_t>(channel);
  const auto time = static_cast<uint64_t>(std::max<int64_t>(received.count(), 0));
  ByteWriter head;
  head.number(static_cast<uint8_t>(Opcode::message));
  head.number(static_cast<uint64_t>(22 + bytes.size()));
  head.number(id);
  head.number(static_cast<uint32_t>(counts_.at(channel)++));
  head.number(time);
  head.number(time);
  span_ = span_ ? std::pair(std::min(span_->first, time), std::max(span_->second, time))
                : std::pair(time, time);
  if (!options_.chunks) {
    put(head);
    file_.write(bytes.data(), bytes.size());
    offset_ += bytes.size();
    return;
  }
  chunk_begin_ = chunk_index_.empty() ? time : std::min(chunk_begin_, time);
  chunk_end_ = chunk_index_.empty() ? time : std::max(chunk_end_, time);
  chunk_index_[id].emplace_back(time, chunk_.size());
  chunk_.bytes(head.content());
  chunk_.bytes(bytes);
  if (chunk_.size() >= options_.chunk_bytes) {
    close_chunk();
  }
}

uint64_t McapWriter::flush() {
  file_.flush();
  return offset_;
}

void McapWriter::close_chunk() {
  if (chunk_index_.empty()) {
    return;
  }
  ChunkEntry entry{.begin = chunk_begin_,
                   .end = chunk_end_,
                   .offset = offset_,
                   .length = 0,
                   .indexes = {},
                   .indexes_length = 0,
                   .packed_size = 0,
                   .unpacked_size = chunk_.size()};
  const std::vector<std::byte> packed = compress(options_.compression, chunk_.content());
  entry.packed_size = packed.size();
  ByteWriter content;
  content.number(entry.begin);
  content.number(entry.end);
  content.number(entry.unpacked_size);
  content.number(crc32(chunk_.content()));
  content.text(options_.compression == Compression::none ? "" : to_string(options_.compression));
  content.number(entry.packed_size);
  content.bytes(packed);
  put(record(Opcode::chunk, content));
  entry.length = offset_ - entry.offset;
  for (auto& [channel, messages] : chunk_index_) {
    std::ranges::stable_sort(messages, {}, &std::pair<uint64_t, uint64_t>::first);
    ByteWriter index;
    index.number(channel);
    index.number(static_cast<uint32_t>(16 * messages.size()));
    for (const auto& [time, at] : messages) {
      index.number(time);
      index.number(at);
    }
    entry.indexes[channel] = offset_;
    put(record(Opcode::message_index, index));
  }
  entry.indexes_length = offset_ - entry.offset - entry.length;
  chunks_.push_back(std::move(entry));
  chunk_.clear();
  chunk_index_.clear();
}

void McapWriter::write_summary() {
  const uint64_t start = offset_;
  ByteWriter summary;
  ByteWriter groups;
  auto end_group = [&, begin = uint64_t{0}](Opcode opcode) mutable {
    if (summary.size() > begin) {
      ByteWriter group;
      group.number(static_cast<uint8_t>(opcode));
      group.number(start + begin);
      group.number(summary.size() - begin);
      groups.bytes(record(Opcode::summary_offset, group).content());
    }
    begin = summary.size();
  };
  const auto add_text = [&](const std::string& text) {
    summary.bytes(std::as_bytes(std::span(text)));
  };
  std::ranges::for_each(schema_records_, add_text);
  end_group(Opcode::schema);
  std::ranges::for_each(channel_records_, add_text);
  end_group(Opcode::channel);
  ByteWriter statistics;
  uint64_t messages = 0;
  for (const uint64_t count : counts_) {
    messages += count;
  }
  statistics.number(messages);
  statistics.number(static_cast<uint16_t>(schema_records_.size()));
  statistics.number(static_cast<uint32_t>(channel_records_.size()));
  statistics.number(uint32_t{0});  // attachments
  statistics.number(uint32_t{0});  // metadata records
  statistics.number(static_cast<uint32_t>(chunks_.size()));
  statistics.number(span_ ? span_->first : 0);
  statistics.number(span_ ? span_->second : 0);
  statistics.number(static_cast<uint32_t>(10 * counts_.size()));
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    statistics.number(static_cast<uint16_t>(i));
    statistics.number(counts_[i]);
  }
  summary.bytes(record(Opcode::statistics, statistics).content());
  end_group(Opcode::statistics);
  for (const ChunkEntry& chunk : chunks_) {
    ByteWriter index;
    index.number(chunk.begin);
    index.number(chunk.end);
    index.number(chunk.offset);
    index.number(chunk.length);
    index.number(static_cast<uint32_t>(10 * chunk.indexes.size()));
    for (const auto& [channel, at] : chunk.indexes) {
      index.number(channel);
      index.number(at);
    }
    index.number(chunk.indexes_length);
    index.text(options_.compression == Compression::none ? "" : to_string(options_.compression));
    index.number(chunk.packed_size);
    index.number(chunk.unpacked_size);
    summary.bytes(record(Opcode::chunk_index, index).content());
  }
  end_group(Opcode::chunk_index);
  const uint64_t groups_start = start + summary.size();
  summary.bytes(groups.content());
  put(summary);
  ByteWriter footer;
  footer.number(static_cast<uint8_t>(Opcode::footer));
  footer.number(uint64_t{mcap::kFooterContent});
  footer.number(start);
  footer.number(groups_start);
  footer.number(crc32(footer.content(), crc32(summary.content())));
  put(footer);
}

void McapWriter::close() {
  close_chunk();
  ByteWriter end;
  end.number(uint32_t{0});  // no check sum over the data: chunks have their own
  put(record(Opcode::data_end, end));
  if (options_.summary) {
    write_summary();
  } else {
    ByteWriter footer;
    footer.number(uint64_t{0});
    footer.number(uint64_t{0});
    footer.number(uint32_t{0});
    put(record(Opcode::footer, footer));
  }
  file_.write(mcap::kMagic.data(), mcap::kMagic.size());
  file_.close();
}

}  // namespace adit
