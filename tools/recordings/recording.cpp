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

std::size_t sweep_topic(const Recording& recording, const fs::path& path,
                        const std::optional<std::string>& name) {
  std::string known;
  std::optional<std::size_t> found;
  std::size_t count = 0;
  for (std::size_t i = 0; i < recording.topics().size(); ++i) {
    const Topic& topic = recording.topics()[i];
    if (topic.kind != TopicKind::sweeps) {
      continue;
    }
    ++count;
    known += (known.empty() ? "" : ", ") + topic.name;
    if (!name || topic.name == *name) {
      found = i;
    }
  }
  if (count == 0) {
    throw InputError(path, {}, "there are no sweeps in it",
                     "`adit inspect` lists what it holds; mapping needs point clouds "
                     "(sensor_msgs/PointCloud2 or Livox's CustomMsg)");
  }
  if (!found) {
    throw InputError(path, {}, "it has no topic of sweeps named " + *name, "It has " + known);
  }
  if (!name && count > 1) {
    throw InputError(path, {}, "it has " + std::to_string(count) + " topics of sweeps: " + known,
                     "Choose one with --topic");
  }
  return *found;
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
