// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "adit/slam/core/frame_tree.hpp"
#include "adit/tools/inspection/recording_findings.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/topics/topic_statistics.hpp"

namespace adit {

/// IMUs that no transform connects with the range sensor, whose topic is `range`: `run` takes their
/// axes for the sensor's.
std::vector<Finding> find_unknown_mountings(const std::vector<Topic>& topics,
                                            const std::vector<TopicStatistics>& statistics,
                                            const FrameTree& frames,
                                            std::optional<std::size_t> range);

}  // namespace adit
