// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

/// What tells a submap which way is up: its z axis.
enum class Vertical {
  unknown,        ///< nothing: its axes are the lidar's
  gravity,        ///< an inertial sensor
  ground,         ///< the ground it lies on, a plane fitted to its points
  rough_gravity,  ///< an inertial sensor whose bias still hides a tilt (kRoughGravity)
};
/// The enumerator's name.
constexpr std::string_view to_string(Vertical vertical) {
  switch (vertical) {
    case Vertical::unknown:
      return "unknown";
    case Vertical::gravity:
      return "gravity";
    case Vertical::ground:
      return "ground";
    case Vertical::rough_gravity:
      return "rough_gravity";
  }
  return "unknown";
}

/// Gravity's direction known worse than this is rough, rad. A sensor that has not turned yet cannot
/// tell a tilt from its accelerometer's bias: its keyframes all err by the same 10 mrad or so.
inline constexpr double kRoughGravity = 0.003;

/// What it says of a node in the graph; nothing but of gravity, since the ground may slope for as
/// long as the map. Errors of gravity come from the accelerometer's bias, which keyframes share:
/// each counts as 20 mrad, so that a hundred know the vertical to 2 mrad. Rough gravity says
/// nothing: the odometry's edges bring what later keyframes know of it.
std::optional<LevelledNode> level_of(NodeId node, Vertical vertical);

}  // namespace adit
