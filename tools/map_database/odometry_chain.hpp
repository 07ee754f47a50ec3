// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "adit/slam/mapping/map_store.hpp"

namespace adit {

/// T_map_keyframe of each keyframe by the odometry's edges alone, from the first one on. What they
/// do not reach begins where the map has it. Keyframes are in order of their ids, as stores give
/// them.
std::vector<Eigen::Isometry3d> odometry_chain(const std::vector<MapKeyframe>& keyframes,
                                              const PoseGraph& graph);

}  // namespace adit
