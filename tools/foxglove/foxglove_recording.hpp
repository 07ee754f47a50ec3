// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "adit/tools/containers/compression.hpp"

namespace adit {

struct FoxgloveOptions {
  std::filesystem::path input;                  ///< the folder of a run, or a map
  std::filesystem::path output;                 ///< NAME.mcap; NAME.foxglove.json comes beside it
  Compression compression = Compression::zstd;  ///< none, lz4 or zstd
};

struct FoxgloveTopic {
  std::string topic;
  std::string type;
  uint64_t messages = 0;
};

struct FoxgloveReport {
  std::vector<FoxgloveTopic> topics;  ///< in the order of their first messages
  std::filesystem::path layout;       ///< that was written
};

/// Writes what a run or a map shows as an MCAP file of Foxglove's schemas in protobuf, and a layout
/// for it; docs/viewing.md has the topics. Frames are `map`, `lidar`, and `world` (east, north, up)
/// where the map has its place on the Earth. Messages are in the order of their stamps; the graph,
/// and the whole cloud thinned, come first. Memory holds one submap at a time. The same input gives
/// the same bytes. Throws UsageError where the output is the input or what was mapped, or no .mcap;
/// InputError and OutputError, and then leaves no file.
FoxgloveReport write_foxglove(const FoxgloveOptions& options, std::ostream& progress);

}  // namespace adit
