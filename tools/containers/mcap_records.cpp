// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/containers/mcap_records.hpp"

#include <utility>

namespace adit::mcap {
namespace {

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
  record.bytes(12, "the statistics");  // attachments, metadata, chunks
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

std::string read_chunk_index_compression(ByteReader record) {
  record.bytes(32, "a chunk's index");  // times, place, length
  const auto length = record.number<uint32_t>("a chunk's index");
  record.bytes(length, "a chunk's index");            // message indexes
  record.bytes(sizeof(uint64_t), "a chunk's index");  // their length
  return record.text("a chunk's index");
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
