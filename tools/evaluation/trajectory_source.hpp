// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Trajectories from whatever holds one.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "adit/tools/results/trajectory_io.hpp"

namespace adit {

/// Where to look for a trajectory.
struct TrajectorySource {
  std::filesystem::path path;
  std::optional<std::filesystem::path> times{};  ///< stamps a KITTI trajectory
  std::string topic{};  ///< NAME or NAME:FRAME, where a recording has several; empty: the only one
};

/// What of a source is looked at.
struct SourceUse {
  bool times = false;  ///< the trajectory has none of its own
  bool topic = false;  ///< it is a recording
};

/// By content. Throws InputError as read_any_trajectory() does.
SourceUse use_of(const std::filesystem::path& path);

/// Reads, by content:
/// - TUM and KITTI text;
/// - tables with a header line: time, position and quaternion, found by their names (EuRoC's
///   data.csv, sweeps.csv and odometry_highrate.csv of a run, the simulator's truth.csv);
/// - the folder of a run: its trajectory.tum;
/// - any recording that `adit run` reads, if it has poses. They are sorted by time.
/// Throws InputError: no trajectory in it, or several and none named.
Trajectory read_any_trajectory(const TrajectorySource& source);

}  // namespace adit
