// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace adit {

/// What `adit record` is asked for.
struct RecordOptions {
  std::vector<std::string> sources{};  ///< udp://ADDRESS:PORT of one sensor, or ROS 2 topics
  std::filesystem::path output{};      ///< NAME.pcap for packets, NAME.mcap for topics
  std::optional<std::filesystem::path> metadata{};  ///< of an Ouster
  double wait_s = 10.0;                             ///< for the first packets or topics
  double duration_s = 0.0;                          ///< 0: until a signal
  double split_s = 0.0;                             ///< of a file; 0: no end
  uint64_t split_bytes = 0;                         ///< of a file; 0: no end
  bool overwrite = false;
  bool quiet = false;
};

/// Records what arrives, without mapping it. With a split, files are NAME_0, NAME_1 and so on; no
/// message is lost between them. Prints a line every ten seconds. Returns 0, or 1 where recording
/// ended early. Throws InputError where nothing arrives, UsageError.
int record(const RecordOptions& options, std::ostream& err);

}  // namespace adit
