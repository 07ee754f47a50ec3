// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "adit/slam/core/frame_tree.hpp"
#include "adit/tools/inspection/recording_findings.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/topics/topic_statistics.hpp"

namespace adit {

/// An IMU of which nothing tells how it is mounted to the first range sensor: `run` takes its axes
/// for the sensor's.
std::vector<Finding> find_unknown_mountings(const std::vector<Topic>& topics,
                                            const std::vector<TopicStatistics>& statistics,
                                            const FrameTree& frames);

}  // namespace adit
