// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The containers that a recording consists of: one, those of a rosbag2 folder, or several that
// follow each other in time.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "adit/tools/containers/message_file.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// The containers in a recording, recognised by content; none where `path` is a recording of
/// another kind or nothing at all. Each file that is declared and missing has a MessageFile, too,
/// without channels and with its contradictions. Files of a folder without metadata.yaml follow
/// each other in time. Throws InputError where one cannot be opened, or where they do not.
std::vector<std::unique_ptr<MessageFile>> open_message_files(const std::filesystem::path& path);

/// The containers of several recordings that are one, in the order of their times. Throws
/// InputError where one is no recording of messages, where their times overlap, or where a topic
/// has another type in another one.
std::vector<std::unique_ptr<MessageFile>> open_message_files(
    const std::vector<std::filesystem::path>& paths);

/// The containers in a folder that its metadata.yaml does not list. They are not read.
std::vector<RecordingNotice> unlisted_file_notices(const std::filesystem::path& path);

}  // namespace adit
