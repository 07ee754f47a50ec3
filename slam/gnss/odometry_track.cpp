// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/gnss/odometry_track.hpp"

#include <algorithm>

#include "adit/slam/core/units.hpp"

namespace adit {

TrackedMotion between(const StampedPose& before, const StampedPose& after, Nanoseconds stamp) {
  const double duration = seconds(after.stamp - before.stamp);
  const double part = seconds(stamp - before.stamp) / duration;
  const Vector6d way = se3_log(before.pose.inverse() * after.pose);
  return {.T_odom_lidar = before.pose * se3_exp(part * way), .twist = way / duration};
}

void OdometryTrack::add(const StampedPose& T_odom_lidar, bool anew) {
  const std::size_t last = knots_.empty() ? 0 : knots_.back().piece;
  knots_.push_back({.pose = T_odom_lidar, .piece = anew ? last + 1 : last});
}

std::optional<std::size_t> OdometryTrack::after(Nanoseconds stamp) const {
  const auto later =
      std::ranges::upper_bound(knots_, stamp, {}, [](const Knot& knot) { return knot.pose.stamp; });
  if (later == knots_.begin() || later == knots_.end()) {
    return std::nullopt;
  }
  const auto i = static_cast<std::size_t>(later - knots_.begin());
  const bool known =
      knots_[i - 1].piece == knots_[i].piece &&
      seconds(knots_[i].pose.stamp - knots_[i - 1].pose.stamp) < kLongestInterpolation;
  return known ? std::optional(i) : std::nullopt;
}

std::optional<TrackedMotion> OdometryTrack::at(Nanoseconds stamp) const {
  const std::optional<std::size_t> i = after(stamp);
  return i ? std::optional(between(knots_[*i - 1].pose, knots_[*i].pose, stamp)) : std::nullopt;
}

std::optional<Eigen::Isometry3d> OdometryTrack::way(Nanoseconds from, Nanoseconds to) const {
  const std::optional<std::size_t> first = after(from);
  const std::optional<std::size_t> second = after(to);
  if (!first || !second || knots_[*first].piece != knots_[*second].piece) {
    return std::nullopt;
  }
  return at(from)->T_odom_lidar.inverse() * at(to)->T_odom_lidar;
}

}  // namespace adit
