// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Which places of a trajectory see the same, so that a loop could be closed between them.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "adit/slam/core/checkpoint.hpp"
#include "adit/tools/simulator/ray_scene.hpp"

namespace adit {

/// T_world_lidar at a time in s from the start.
using PoseAtTime = std::function<Eigen::Isometry3d(double)>;

/// What counts as a loop.
struct LoopOptions {
  double spacing = 1.0;     ///< m of path between the places that are compared, at least
  double apart = 15.0;      ///< m of path between the two places of a pair, at least
  double detour = 2.0;      ///< that path over their distance, at least: not just straight on
  double reach = 20.0;      ///< m between them, at most
  double overlap = 0.3;     ///< at least
  std::size_t most = 2000;  ///< places; more are thinned out
  double range = 60.0;      ///< m, what is farther does not count as seen
};

/// Two moments, the later one second.
struct LoopPair {
  double time_a = 0.0;    ///< s from the start
  double time_b = 0.0;    ///< s
  double distance = 0.0;  ///< m between the two places
  double angle = 0.0;     ///< rad between the two attitudes
  double overlap = 0.0;   ///< share, see find_loops()
};

/// Pairs of places along the first `duration` seconds. Their overlap is the share of what a sensor
/// sees from one of them that is also in sight of the other, the lesser of the two directions.
/// `directions` (unit length, lidar) are those in which the sensor looks; what moves is left out.
std::vector<LoopPair> find_loops(const PoseAtTime& T_world_lidar, double duration,
                                 std::span<const Eigen::Vector3d> directions, const RayScene& still,
                                 const LoopOptions& options = {},
                                 const Checkpoint& checkpoint = {});

/// Writes them as CSV with a head line, times counted from `epoch` (s). Throws OutputError.
void write_loops(const std::filesystem::path& file, std::span<const LoopPair> loops, double epoch);

}  // namespace adit
