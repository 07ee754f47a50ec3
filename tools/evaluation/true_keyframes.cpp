// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/evaluation/true_keyframes.hpp"

#include <algorithm>
#include <chrono>

#include "adit/slam/core/lie.hpp"
#include "adit/tools/map_database/map_trajectory.hpp"

namespace adit {
namespace {

using std::chrono::milliseconds;

constexpr Nanoseconds kLongestStep = milliseconds(200);
constexpr Nanoseconds kNearestTruth = milliseconds(20);

}  // namespace

std::optional<Eigen::Isometry3d> pose_at(const Trajectory& truth, Nanoseconds stamp) {
  const auto after = std::ranges::lower_bound(truth.poses, stamp, {}, &StampedPose::stamp);
  const bool has_after = after != truth.poses.end();
  const bool has_before = after != truth.poses.begin();
  if (has_after && after->stamp == stamp) {
    return after->pose;
  }
  if (has_after && has_before && after->stamp - std::prev(after)->stamp <= kLongestStep) {
    const StampedPose& before = *std::prev(after);
    const double share = seconds(stamp - before.stamp) / seconds(after->stamp - before.stamp);
    return before.pose * se3_exp(share * se3_log(before.pose.inverse() * after->pose));
  }
  if (has_after && after->stamp - stamp <= kNearestTruth) {
    return after->pose;
  }
  if (has_before && stamp - std::prev(after)->stamp <= kNearestTruth) {
    return std::prev(after)->pose;
  }
  return std::nullopt;
}

std::map<NodeId, TrueKeyframe> true_keyframes(const MapDatabase& map,
                                              const std::filesystem::path& file,
                                              const Trajectory& truth) {
  std::map<NodeId, TrueKeyframe> result;
  for (const MapKeyframe& keyframe : map.keyframes()) {
    const KeyframeSubmap submap = load_sweeps(map, keyframe.id, file);
    const auto pose = pose_at(truth, keyframe.stamp);
    if (pose && !submap.sweeps.empty()) {
      result[keyframe.id] = {keyframe.stamp,
                             *pose * submap.sweeps.front().T_keyframe_lidar.inverse()};
    }
  }
  return result;
}

}  // namespace adit
