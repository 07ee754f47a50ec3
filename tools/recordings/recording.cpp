// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/recording.hpp"

#include <type_traits>

#include "adit/tools/containers/bag_reader.hpp"
#include "adit/tools/containers/mcap_reader.hpp"
#include "adit/tools/containers/packed_messages.hpp"
#include "adit/tools/containers/rosbag2_reader.hpp"
#include "adit/tools/packets/packet_capture.hpp"
#include "adit/tools/recordings/capture_recording.hpp"
#include "adit/tools/recordings/euroc_folder.hpp"
#include "adit/tools/recordings/message_recording.hpp"
#include "adit/tools/recordings/sweep_files.hpp"
#include "adit/tools/recordings/tum_folder.hpp"

namespace adit {

namespace fs = std::filesystem;

std::string_view to_string(TopicKind kind) {
  switch (kind) {
    case TopicKind::sweeps:
      return "sweeps";
    case TopicKind::imu:
      return "imu";
    case TopicKind::gnss:
      return "gnss";
    case TopicKind::poses:
      return "poses";
    case TopicKind::transforms:
      return "transforms";
    case TopicKind::other:
      return "other";
  }
  return "unknown";
}

Nanoseconds stamp_of(const Event& event) {
  return std::visit(
      [&](const auto& value) {
        if constexpr (requires { value.stamp; }) {
          return value.stamp;
        } else {
          return event.received;
        }
      },
      event.value);
}

namespace {

/// One that is not packed.
std::unique_ptr<MessageFile> open_plain_file(const fs::path& path) {
  if (is_mcap(path)) {
    return open_mcap(path);
  }
  if (is_bag(path)) {
    return open_bag(path);
  }
  return is_rosbag2_database(path) ? open_rosbag2_database(path) : nullptr;
}

/// Recognised by content; null where it is no container.
std::unique_ptr<MessageFile> open_message_file(const fs::path& path) {
  if (is_zstd_file(path)) {
    return open_packed_file(path, open_plain_file);
  }
  return open_plain_file(path);
}

}  // namespace

std::vector<std::unique_ptr<MessageFile>> open_message_files(const fs::path& path) {
  std::error_code ignored;
  std::vector<std::unique_ptr<MessageFile>> files;
  if (fs::is_regular_file(path, ignored)) {
    if (std::unique_ptr<MessageFile> file = open_message_file(path)) {
      files.push_back(std::move(file));
    }
  } else if (fs::is_directory(path, ignored)) {
    for (const fs::path& part : rosbag2_files(path)) {
      std::unique_ptr<MessageFile> file = open_message_file(part);
      if (!file) {
        throw InputError(part, Place::byte(0), "it is neither an MCAP file nor an SQLite database",
                         "The file is damaged: copy it again, or move it out of the folder");
      }
      files.push_back(std::move(file));
    }
  }
  return files;
}

std::unique_ptr<Recording> open_recording(const fs::path& path, const fs::path& metadata) {
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored) && is_packet_capture(path)) {
    return open_packet_capture(path, metadata);
  }
  if (is_euroc_folder(path)) {
    return open_euroc_folder(path);
  }
  if (is_tum_folder(path)) {
    return open_tum_folder(path);
  }
  std::vector<std::unique_ptr<MessageFile>> files = open_message_files(path);
  return files.empty() ? open_sweep_files(path)
                       : make_message_recording(path, std::move(files), metadata);
}

}  // namespace adit
