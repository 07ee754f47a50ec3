// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adit/tools/containers/byte_reader.hpp"
#include "adit/tools/containers/compression.hpp"
#include "adit/tools/containers/mcap_records.hpp"
#include "adit/tools/containers/message_writer.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {

struct McapOptions {
  Compression compression = Compression::zstd;  ///< none, lz4 or zstd
  bool chunks = true;                           ///< false: messages one by one, uncompressed
  uint64_t chunk_bytes = uint64_t{1} << 20U;    ///< a chunk is closed once it has this many
  bool summary = true;                          ///< with statistics and the index of the chunks
  std::string
      profile{};  ///< "ros1" or "ros2" where all channels are of one; some readers ask for it
};

/// How a topic's messages are described and laid out, by MCAP's registry: ROS's are told by
/// Channel.
struct McapSchema {
  std::string name;              ///< of the type: "foxglove.PointCloud"
  std::string encoding;          ///< of `data`: "protobuf"
  std::string data;              ///< what a reader needs to know of the type
  std::string message_encoding;  ///< of the messages: "protobuf"
};

/// Writes an MCAP file after its specification, version 0.
class McapWriter final : public MessageWriter {
 public:
  McapWriter(const std::filesystem::path& path, const McapOptions& options);

  std::size_t add_channel(const Channel& channel) override;
  /// A topic of messages that are none of ROS's. A schema's name and encoding stand for its data.
  std::size_t add_channel(const std::string& topic, const McapSchema& schema,
                          const std::map<std::string, std::string>& metadata = {});
  void write(std::size_t channel, Nanoseconds received, std::span<const std::byte> bytes) override;
  void close() override;
  /// Hands what was written, but for an open chunk, to the operating system. Returns the file's
  /// length then.
  uint64_t flush();

 private:
  /// Where a chunk went, for the index.
  struct ChunkEntry {
    uint64_t begin = 0;  // ns
    uint64_t end = 0;
    uint64_t offset = 0;
    uint64_t length = 0;
    std::map<uint16_t, uint64_t> indexes;  // channel: where its message index is
    uint64_t indexes_length = 0;
    uint64_t packed_size = 0;
    uint64_t unpacked_size = 0;
  };

  void put(const ByteWriter& record);
  void close_chunk();
  void write_summary();

  OutputFile file_;
  McapOptions options_;
  uint64_t offset_ = 0;
  std::map<std::pair<std::string, std::string>, uint16_t> schemas_;  // by name and encoding
  std::vector<std::string> schema_records_;                          // for the summary
  std::vector<std::string> channel_records_;
  std::vector<uint64_t> counts_;  // messages, by channel
  std::optional<std::pair<uint64_t, uint64_t>> span_;
  std::vector<ChunkEntry> chunks_;

  ByteWriter chunk_;
  std::map<uint16_t, std::vector<std::pair<uint64_t, uint64_t>>> chunk_index_;
  uint64_t chunk_begin_ = 0;
  uint64_t chunk_end_ = 0;
};

}  // namespace adit
