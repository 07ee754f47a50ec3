// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>

#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/results/trajectory_io.hpp"

namespace adit {

/// The true pose at a time: between two poses at most 0.2 s apart at constant velocity, else one
/// that is at most 20 ms away. `truth` is in the order of its stamps.
std::optional<Eigen::Isometry3d> pose_at(const Trajectory& truth, Nanoseconds stamp);

/// Where a keyframe of a map really was.
struct TrueKeyframe {
  Nanoseconds stamp{0};
  Eigen::Isometry3d T_world_keyframe = Eigen::Isometry3d::Identity();
};

/// The keyframes that the truth covers. `file` is for messages; throws InputError where the map is
/// damaged.
std::map<NodeId, TrueKeyframe> true_keyframes(const MapDatabase& map,
                                              const std::filesystem::path& file,
                                              const Trajectory& truth);

}  // namespace adit
