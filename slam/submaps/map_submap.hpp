// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "adit/slam/core/types.hpp"
#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

/// What a keyframe has seen, in its own frame.
struct MapSubmap {
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();  ///< corners of the box around it, m
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();  ///< the upper one
  std::vector<std::vector<std::byte>> chunks;       ///< their content is mapping's own affair
};

/// Reads the stored submap of a keyframe; throws what the store throws.
using SubmapLoader = std::function<MapSubmap(NodeId keyframe)>;

}  // namespace adit
