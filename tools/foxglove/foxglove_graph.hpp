// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A map's graph as what a viewer draws, in the map's axes.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "adit/slam/mapping/map_store.hpp"
#include "adit/tools/foxglove/foxglove_messages.hpp"
#include "adit/tools/foxglove/foxglove_scene.hpp"

namespace adit {

inline constexpr const char* kTrajectoryTopic = "/graph/trajectory";
inline constexpr const char* kKeyframesTopic = "/graph/keyframes";
inline constexpr const char* kOdometryTopic = "/graph/odometry";
inline constexpr const char* kConstraintsTopic = "/graph/constraints";
inline constexpr const char* kLoopsTopic = "/graph/loops";
inline constexpr const char* kUncertaintyTopic = "/graph/uncertainty";

/// What is drawn of a graph, with the topic that it goes to, so that each can be hidden alone.
struct ShownPart {
  std::string topic;
  ShownEntity entity;
};

/// The way of a sensor; `parts` are where it begins anew, the first excepted. Evenly thinned to
/// 65535 poses.
ShownPart shown_trajectory(std::span<const StampedPose> poses, std::span<const std::size_t> parts);

/// Keyframes, where the odometry alone has them, the constraints between them, loops by verdict,
/// and three standard deviations of their positions (of 2000 of them, evenly chosen).
std::vector<ShownPart> shown_graph(const MapStore& map);

/// What a loop candidate came to: a line of a log, at its later keyframe's stamp.
struct ShownEvent {
  Nanoseconds stamp{0};
  ShownLevel level = ShownLevel::info;
  std::string text;
};
std::vector<ShownEvent> loop_events(const MapStore& map);

}  // namespace adit
