// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/recordings/recording.hpp"

#include <type_traits>

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
    case TopicKind::velocities:
      return "velocities";
    case TopicKind::headings:
      return "headings";
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
                       : make_message_recording({path}, std::move(files), metadata);
}

std::unique_ptr<Recording> open_recording(const std::vector<fs::path>& paths,
                                          const fs::path& metadata) {
  return paths.size() == 1 ? open_recording(paths.front(), metadata)
                           : make_message_recording(paths, open_message_files(paths), metadata);
}

std::string text_of(const std::vector<fs::path>& paths) {
  std::string text;
  for (const fs::path& path : paths) {
    text += (text.empty() ? "" : ", ") + path.string();
  }
  return text;
}

}  // namespace adit
