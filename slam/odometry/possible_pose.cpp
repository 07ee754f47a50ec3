// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/odometry/possible_pose.hpp"

#include <cmath>

namespace adit {
namespace {

// So far poses may be apart however little time their stamps say has passed.
constexpr double kUntimed = 1.0;  // m

}  // namespace

std::optional<Rejection> impossible_pose(const StampedPose& pose,
                                         const std::optional<StampedPose>& last, double max_speed) {
  if (!pose.pose.matrix().allFinite()) {
    return PoseNotFinite{};
  }
  if (!last) {
    return std::nullopt;
  }
  const double moved = (pose.pose.translation() - last->pose.translation()).norm();
  // As differences of numbers: stamps from anywhere would overflow whole nanoseconds.
  const double elapsed = 1e-9 * std::abs(static_cast<double>(pose.stamp.count()) -
                                         static_cast<double>(last->stamp.count()));
  if (moved <= kUntimed + max_speed * elapsed) {
    return std::nullopt;
  }
  return MovedTooFar{.distance = moved, .elapsed = elapsed, .max_speed = max_speed};
}

}  // namespace adit
