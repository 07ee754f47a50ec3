// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adit/tools/containers/message_writer.hpp"
#include "adit/tools/containers/sqlite_database.hpp"

namespace adit {

struct Rosbag2Options {
  bool pack_messages = false;          ///< each one with Zstandard
  std::string ros_distro = "unknown";  ///< that the messages were recorded with
};

/// Writes a rosbag2 folder: FOLDER/NAME_0.db3 (SQLite) and FOLDER/metadata.yaml, as ROS 2 Jazzy
/// does. The folder must not exist, or be empty. Messages are committed every few MiB: where the
/// process is killed, those before can be read.
class Rosbag2Writer final : public MessageWriter {
 public:
  Rosbag2Writer(const std::filesystem::path& folder, const Rosbag2Options& options);

  std::size_t add_channel(const Channel& channel) override;
  void write(std::size_t channel, Nanoseconds received, std::span<const std::byte> bytes) override;
  void close() override;

 private:
  std::filesystem::path folder_;
  std::string file_name_;
  Rosbag2Options options_;
  SqliteDatabase database_;
  SqliteStatement insert_;
  uint64_t uncommitted_ = 0;       // bytes of messages
  std::vector<Channel> channels_;  // with the number of their messages
  std::optional<TimeSpan> span_;
};

}  // namespace adit
