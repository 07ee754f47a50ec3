// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "adit/tools/containers/message_file.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// A recording of messages, in one file or split over several that follow each other in time.
/// Channels of the same topic, type and encoding are one topic. `path` is for descriptions;
/// `metadata` is of the sensor whose packets are in messages (packet_messages.hpp), or empty.
std::unique_ptr<Recording> make_message_recording(const std::filesystem::path& path,
                                                  std::vector<std::unique_ptr<MessageFile>> files,
                                                  const std::filesystem::path& metadata = {});

/// The containers in a recording, recognised by content; none where `path` is a recording of
/// another kind or nothing at all. Throws InputError where one cannot be opened.
std::vector<std::unique_ptr<MessageFile>> open_message_files(const std::filesystem::path& path);

}  // namespace adit
