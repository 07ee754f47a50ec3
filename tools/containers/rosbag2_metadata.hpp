// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// metadata.yaml of a rosbag2 folder, version 9, and the qualities of service in it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adit/tools/containers/message_file.hpp"

namespace adit {

/// What metadata.yaml tells.
struct Rosbag2Metadata {
  std::vector<Channel> channels{};  ///< with the number of their messages
  std::optional<TimeSpan> span{};   ///< time span of the messages
  bool packed_messages = false;     ///< each one with Zstandard
  std::string file{};               ///< name of the one storage file
  std::string ros_distro{};
};
std::string to_yaml(const Rosbag2Metadata& metadata);

/// The profiles of quality of service as version 9 writes them, policies by their names ("history:
/// keep_last"); versions up to 8 had numbers ("history: 1"). Empty where there are none, or where
/// the text is no YAML sequence.
std::string named_qos_profiles(const std::string& text);

/// What metadata.yaml declares to be in the recording's folder.
struct Rosbag2Declaration {
  std::vector<std::filesystem::path> files{};              ///< in their order, as they are written
  std::vector<std::pair<std::string, uint64_t>> topics{};  ///< names, and how many messages
  std::optional<uint64_t> messages{};                      ///< in all
};

/// A metadata.yaml that cannot be understood, or lists no file.
class UnusableMetadata : public InputError {
 public:
  using InputError::InputError;
};

/// What metadata.yaml in a folder declares; nothing where there is no such file. Throws
/// UnusableMetadata.
std::optional<Rosbag2Declaration> read_rosbag2_declaration(const std::filesystem::path& folder);

/// `path`, or its folder where it is the metadata.yaml of a rosbag2 recording.
std::filesystem::path without_metadata_file(const std::filesystem::path& path);

/// The ROS distribution that metadata.yaml in a folder names; empty where there is none.
std::string told_ros_distro(const std::filesystem::path& folder);

}  // namespace adit
