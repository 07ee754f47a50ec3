// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The records of an MCAP file (version 0), after its specification at mcap.dev/spec.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

#include "adit/tools/containers/byte_reader.hpp"

namespace adit::mcap {

inline constexpr std::array<unsigned char, 8> kMagic = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
inline constexpr std::size_t kRecordHeader = 9;    ///< opcode and 64-bit length
inline constexpr std::size_t kFooterContent = 20;  ///< bytes

enum class Opcode : uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0a,
  statistics = 0x0b,
  metadata = 0x0c,
  metadata_index = 0x0d,
  summary_offset = 0x0e,
  data_end = 0x0f,
};

struct Schema {
  uint16_t id = 0;
  std::string name;
  std::string encoding;
  std::string data;
};
Schema read_schema(ByteReader record);

struct Channel {
  uint16_t id = 0;
  uint16_t schema = 0;
  std::string topic;
  std::string message_encoding;
  std::map<std::string, std::string> metadata;
};
Channel read_channel(ByteReader record);

/// What stands before a message's bytes.
struct MessageHeader {
  uint16_t channel = 0;
  uint32_t sequence = 0;
  uint64_t log_time = 0;      ///< ns
  uint64_t publish_time = 0;  ///< ns
};
MessageHeader read_message_header(ByteReader& record);

/// What stands before a chunk's records.
struct ChunkHeader {
  uint64_t begin = 0;  ///< ns, earliest log time; 0 with `end` 0 where there are no messages
  uint64_t end = 0;
  uint64_t unpacked_size = 0;
  uint32_t unpacked_crc = 0;  ///< 0: not given
  std::string compression;
  uint64_t packed_size = 0;
};
ChunkHeader read_chunk_header(ByteReader& record);

struct Statistics {
  uint64_t messages = 0;
  uint32_t channels = 0;
  uint32_t attachments = 0;
  uint32_t chunks = 0;
  uint64_t begin = 0;  ///< ns
  uint64_t end = 0;
  std::map<uint16_t, uint64_t> channel_messages;  ///< empty: not given
};
Statistics read_statistics(ByteReader record);

/// An entry of the chunk index.
struct ChunkIndex {
  uint64_t begin = 0;  ///< ns, earliest log time; 0 with `end` 0 where there are no messages
  uint64_t end = 0;
  uint64_t offset = 0;                            ///< byte of the file where the chunk begins
  std::map<uint16_t, uint64_t> channel_messages;  ///< empty: there is no index of messages
  std::string compression;
};
ChunkIndex read_chunk_index(ByteReader record);

/// A record of names and values for programs, such as rosbag2's.
struct Metadata {
  std::string name;
  std::map<std::string, std::string> values;
};
Metadata read_metadata(ByteReader record);

/// Where such a record is.
struct MetadataIndex {
  uint64_t offset = 0;
  uint64_t length = 0;
  std::string name;
};
MetadataIndex read_metadata_index(ByteReader record);

struct Footer {
  uint64_t summary_start = 0;  ///< 0: no summary
  uint64_t summary_offset_start = 0;
  uint32_t summary_crc = 0;  ///< 0: not given
};
Footer read_footer(ByteReader record);

}  // namespace adit::mcap
