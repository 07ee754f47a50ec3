// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "adit/tools/containers/message_file.hpp"
#include "adit/tools/recordings/message_files.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// A recording of messages, in one file or split over several. Channels of the same topic, type and
/// encoding are one topic. Messages come in the order of their times also where the files have them
/// grouped by topic. `paths` are for descriptions, and for what lies beside the first; `metadata`
/// is of the sensor whose packets are in messages (packet_messages.hpp), or empty.
std::unique_ptr<Recording> make_message_recording(std::vector<std::filesystem::path> paths,
                                                  std::vector<std::unique_ptr<MessageFile>> files,
                                                  const std::filesystem::path& metadata = {});

}  // namespace adit
