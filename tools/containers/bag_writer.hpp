// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "adit/tools/containers/byte_reader.hpp"
#include "adit/tools/containers/compression.hpp"
#include "adit/tools/containers/message_writer.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {

struct BagOptions {
  Compression compression = Compression::lz4;  ///< none, lz4 or bz2
  uint64_t chunk_bytes = 768U << 10U;          ///< a chunk is closed once it has this many
};

/// Writes a ROS 1 bag of version 2.0, with its index.
class BagWriter final : public MessageWriter {
 public:
  BagWriter(const std::filesystem::path& path, const BagOptions& options);

  std::size_t add_channel(const Channel& channel) override;
  void write(std::size_t channel, Nanoseconds received, std::span<const std::byte> bytes) override;
  void close() override;

 private:
  /// Where a chunk went, for the index.
  struct ChunkEntry {
    uint64_t offset = 0;
    Nanoseconds begin{0};
    Nanoseconds end{0};
    std::map<uint32_t, uint32_t> counts;
  };

  void put(const ByteWriter& bytes);
  void close_chunk();

  OutputFile file_;
  BagOptions options_;
  uint64_t offset_ = 0;
  std::vector<std::string> connections_;  // their records, by channel
  std::vector<bool> told_;                // in some chunk already
  std::vector<ChunkEntry> chunks_;
  ByteWriter chunk_;
  std::map<uint32_t, std::vector<std::pair<Nanoseconds, uint32_t>>> chunk_index_;
};

}  // namespace adit
