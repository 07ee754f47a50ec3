// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adit/slam/core/recording_config.hpp"
#include "adit/tools/containers/compression.hpp"
#include "adit/tools/containers/message_file.hpp"
#include "adit/tools/export/recording_converter.hpp"

namespace adit {

struct ConvertOptions {
  std::filesystem::path input{};
  std::vector<std::filesystem::path> further_inputs{};  ///< parts of it that follow in time
  bool overwrite = false;                    ///< replace a recording that is there already
  std::filesystem::path output{};            ///< NAME.mcap, NAME.bag (ROS 1), or a folder (rosbag2)
  std::vector<std::string> topics{};         ///< those to keep; empty: all
  std::optional<double> begin_s{};           ///< s after the first message
  std::optional<double> end_s{};             ///< s after the first message
  std::optional<Encoding> encoding{};        ///< for MCAP; none: as it is
  std::optional<Compression> compression{};  ///< none: the format's usual one
  std::optional<std::string> metadata{};  ///< RecordingConfig::metadata, where nothing is repaired
  std::optional<RecordingConfig> repair{};  ///< write sweeps and IMU samples as they are understood
  bool foxglove = false;  ///< `input` is a run or a map: write what it shows, by Foxglove's schemas
};

/// Writes a recording anew: in another format, between ROS 1 and ROS 2, with fewer topics, cut in
/// time. A part that begins later starts with the messages that hold until the next one (static
/// transforms, calibrations of cameras, latched topics), as received at its begin. Messages whose
/// encoding stays are copied byte for byte, of whatever type; but for those that are repaired:
/// sweeps become PointCloud2 with x y z intensity, ring and time (float32, s after the stamp, which
/// is their start), IMU samples keep rates and accelerations. Damage is reported and passed over.
/// `foxglove` is not looked at here. Throws UsageError where the options contradict each other,
/// InputError where the input cannot be opened, OutputError where the result cannot be written.
ConvertReport convert_recording(const ConvertOptions& options);

/// Throws UsageError where the output is there already and is not to be replaced, or is a folder
/// that holds what is read.
void require_free_output(const ConvertOptions& options);

}  // namespace adit
