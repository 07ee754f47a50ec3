// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "adit/slam/core/recording_config.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// The event with its time and its units corrected.
EventValue corrected(EventValue value, const RecordingConfig& config);

/// A recording as the configuration says it is to be understood: its events come corrected. Times
/// of receipt, and with them the selection by time, are the recorder's own. Throws as
/// open_recording() does.
std::unique_ptr<Recording> open_recording(const std::filesystem::path& path,
                                          const RecordingConfig& config);
std::unique_ptr<Recording> open_recording(const std::vector<std::filesystem::path>& paths,
                                          const RecordingConfig& config);

/// Reads the first sweeps of a topic and throws InputError where the times of their points cannot
/// be meant as they are understood: sweeps that last longer than it takes to the next, or next to
/// no time. Says what to put into the configuration. Throws likewise where the coordinates are
/// rounded to float32 so far from the origin that a centimetre is lost. Returns the points of the
/// largest of them.
std::size_t require_clear_point_times(const Recording& recording, std::size_t topic,
                                      const std::filesystem::path& path);

/// The recording with what the configuration corrects of it.
std::unique_ptr<Recording> configured(std::unique_ptr<Recording> recording,
                                      const RecordingConfig& config);

}  // namespace adit
