// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "tools/frame_tree.hpp"
#include "tools/recording_findings.hpp"
#include "tools/recordings/recording.hpp"
#include "tools/topic_statistics.hpp"

namespace adit {

/// T_imu_lidar as the recording's static transforms tell it: maps coordinates in the frame of the
/// sweeps' messages to the frame of the IMU's. None where the recording has no transforms or does
/// not name the frames; reads up to the first message of each topic, and the transforms of the
/// first ten seconds.
std::optional<Eigen::Isometry3d> recorded_mounting(const Recording& recording,
                                                   std::size_t sweep_topic, std::size_t imu_topic);

/// An IMU of which nothing tells how it is mounted to the first range sensor: `run` takes its axes
/// for the sensor's.
std::vector<Finding> find_unknown_mountings(const std::vector<Topic>& topics,
                                            const std::vector<TopicStatistics>& statistics,
                                            const FrameTree& frames);

}  // namespace adit
