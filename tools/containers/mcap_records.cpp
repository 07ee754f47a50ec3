// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/mcap_records.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace adit::mcap {
namespace {

/// Numbers of messages by channel, from the places of their indexes: one behind the other in the
/// file, 16 bytes a message. Empty where they make no sense.
std::map<uint16_t, uint64_t> message_counts(const std::map<uint16_t, uint64_t>& offsets,
                                            uint64_t length) {
  constexpr uint64_t kIndexHead = kRecordHeader + sizeof(uint16_t) + sizeof(uint32_t);
  constexpr uint64_t kEntry = 2 * sizeof(uint64_t);
  std::vector<std::pair<uint64_t, uint16_t>> places;
  for (const auto& [channel, offset] : offsets) {
    places.emplace_back(offset, channel);
  }
  std::ranges::sort(places);
  std::map<uint16_t, uint64_t> counts;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const uint64_t begin = places[i].first - places.front().first;
    const uint64_t end =
        i + 1 < places.size() ? places[i + 1].first - places.front().first : length;
    if (end < begin || end - begin < kIndexHead || (end - begin - kIndexHead) % kEntry != 0) {
      return {};
    }
    counts[places[i].second] = (end - begin - kIndexHead) / kEntry;
  }
  return counts;
}

/// A length in bytes and as many bytes of names and values.
std::map<std::string, std::string> read_pairs(ByteReader& record, const char* what) {
  std::map<std::string, std::string> values;
  ByteReader pairs = record.part(record.number<uint32_t>(what), what);
  while (pairs.remaining() > 0) {
    std::string key = pairs.text(what);
    values[std::move(key)] = pairs.text(what);
  }
  return values;
}

}  // namespace

Schema read_schema(ByteReader record) {
  Schema schema;
  schema.id = record.number<uint16_t>("a schema's id");
  schema.name = record.text("a schema's name");
  schema.encoding = record.text("a schema's encoding");
  schema.data = record.text("a schema's text");
  return schema;
}

Channel read_channel(ByteReader record) {
  Channel channel;
  channel.id = record.number<uint16_t>("a channel's id");
  channel.schema = record.number<uint16_t>("a channel's schema");
  channel.topic = record.text("a channel's topic");
  channel.message_encoding = record.text("a channel's message encoding");
  channel.metadata = read_pairs(record, "a channel's metadata");
  return channel;
}

MessageHeader read_message_header(ByteReader& record) {
  MessageHeader message;
  message.channel = record.number<uint16_t>("a message's channel");
  message.sequence = record.number<uint32_t>("a message's sequence number");
  message.log_time = record.number<uint64_t>("a message's log time");
  message.publish_time = record.number<uint64_t>("a message's publish time");
  return message;
}

ChunkHeader read_chunk_header(ByteReader& record) {
  ChunkHeader chunk;
  chunk.begin = record.number<uint64_t>("a chunk's start time");
  chunk.end = record.number<uint64_t>("a chunk's end time");
  chunk.unpacked_size = record.number<uint64_t>("a chunk's size");
  chunk.unpacked_crc = record.number<uint32_t>("a chunk's check sum");
  chunk.compression = record.text("a chunk's compression");
  chunk.packed_size = record.number<uint64_t>("a chunk's packed size");
  return chunk;
}

Statistics read_statistics(ByteReader record) {
  Statistics statistics;
  statistics.messages = record.number<uint64_t>("the statistics");
  record.number<uint16_t>("the statistics");  // schemas
  statistics.channels = record.number<uint32_t>("the statistics");
  statistics.attachments = record.number<uint32_t>("the statistics");
  record.number<uint32_t>("the statistics");  // metadata
  statistics.chunks = record.number<uint32_t>("the statistics");
  statistics.begin = record.number<uint64_t>("the statistics");
  statistics.end = record.number<uint64_t>("the statistics");
  const auto length = record.number<uint32_t>("the statistics");
  ByteReader counts = record.part(length, "the statistics");
  while (counts.remaining() > 0) {
    const auto id = counts.number<uint16_t>("the statistics");
    statistics.channel_messages[id] = counts.number<uint64_t>("the statistics");
  }
  return statistics;
}

ChunkIndex read_chunk_index(ByteReader record) {
  ChunkIndex index;
  index.begin = record.number<uint64_t>("a chunk's index");
  index.end = record.number<uint64_t>("a chunk's index");
  index.offset = record.number<uint64_t>("a chunk's index");
  record.number<uint64_t>("a chunk's index");  // length
  ByteReader places = record.part(record.number<uint32_t>("a chunk's index"), "a chunk's index");
  std::map<uint16_t, uint64_t> offsets;
  while (places.remaining() > 0) {
    const auto channel = places.number<uint16_t>("a chunk's index");
    offsets[channel] = places.number<uint64_t>("a chunk's index");
  }
  const auto length = record.number<uint64_t>("a chunk's index");
  index.channel_messages = message_counts(offsets, length);
  index.compression = record.text("a chunk's index");
  return index;
}

Metadata read_metadata(ByteReader record) {
  Metadata metadata;
  metadata.name = record.text("a metadata record's name");
  metadata.values = read_pairs(record, "a metadata record");
  return metadata;
}

MetadataIndex read_metadata_index(ByteReader record) {
  MetadataIndex index;
  index.offset = record.number<uint64_t>("the index of metadata");
  index.length = record.number<uint64_t>("the index of metadata");
  index.name = record.text("the index of metadata");
  return index;
}

Footer read_footer(ByteReader record) {
  Footer footer;
  footer.summary_start = record.number<uint64_t>("the footer");
  footer.summary_offset_start = record.number<uint64_t>("the footer");
  footer.summary_crc = record.number<uint32_t>("the footer");
  return footer;
}

}  // namespace adit::mcap
