// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/slam/core/frame_tree.hpp"
#include "adit/tools/inspection/lidar_mounting.hpp"
#include "adit/tools/inspection/motion_check.hpp"
#include "adit/tools/inspection/recording_findings.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/setup/device_session.hpp"
#include "adit/tools/setup/sensor_topics.hpp"
#include "adit/tools/topics/topic_statistics.hpp"

namespace adit {

/// A recording after it was read.
struct Inspection {
  std::string description;
  std::vector<Topic> topics;
  std::vector<TopicStatistics> statistics;  ///< one a topic
  FrameTree frames;                         ///< of all static transforms, and what a run adds
  std::optional<std::size_t> sweeps{};      ///< the topic that a run maps, or the first with sweeps
  RecordedSensors sensors{};                ///< what a run uses besides
  std::vector<StaticTransform> scaled{};    ///< whose quaternions are not of length 1, each once
  std::vector<MotionCheck> motion;          ///< from the first sweeps, with every IMU
  std::vector<LidarMounting> lidars{};      ///< of the range sensors that are merged with the first
  std::vector<Finding> findings;
};

/// Reads all of a recording (see open_recording() of several paths), and a stretch of it a second
/// time to compare its sensors' rotations on the device. Throws InputError where it cannot be
/// opened, UsageError for a device that is not there; where there is none at all the rotations are
/// not compared, and a finding says so. `config` says how the recording is to be understood.
Inspection inspect(const std::vector<std::filesystem::path>& paths, const Config& config,
                   const DeviceOptions& device);

bool has_problem(const Inspection& inspection);

}  // namespace adit
