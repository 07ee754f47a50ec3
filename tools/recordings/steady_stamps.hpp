// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// The events without those whose stamp alone leaps: by more than 10 s against the time of receipt,
/// compared with the messages of the topic before it, while those that follow do not. Three in a
/// row that leap alike are a clock that was set, and pass, in their order. For each that is left
/// out the stream throws an InputError (naming `file`), and goes on. Poses and transforms pass as
/// they are.
///
/// One stamp of the future would else leave out whatever comes after it.
std::unique_ptr<EventStream> with_steady_stamps(std::unique_ptr<EventStream> events,
                                                const std::vector<Topic>& topics,
                                                std::filesystem::path file);

}  // namespace adit
