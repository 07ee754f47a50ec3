// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/types.hpp"

namespace adit {

/// Where the lidar was and how it moved, by the odometry.
struct TrackedMotion {
  Eigen::Isometry3d T_odom_lidar = Eigen::Isometry3d::Identity();
  /// Its velocity and turn rate in the lidar's axes: [m/s, rad/s].
  Vector6d twist = Vector6d::Zero();
};

/// The odometry's poses, one a sweep, for what is looked for between them afterwards.
class OdometryTrack {
 public:
  /// Stamps increase. `anew`: nothing is known of the way from the pose before.
  void add(const StampedPose& T_odom_lidar, bool anew);

  /// Between two sweeps, by their relative pose at a constant twist. None: before the first pose,
  /// after the last, or where the odometry began anew or paused.
  std::optional<TrackedMotion> at(Nanoseconds stamp) const;

  /// T_from_to, the lidar's way from one time to another. None: the poses do not tell it.
  std::optional<Eigen::Isometry3d> way(Nanoseconds from, Nanoseconds to) const;

 private:
  struct Knot {
    StampedPose pose;
    std::size_t piece = 0;  ///< of those that the odometry's restarts part
  };
  /// The later of the two knots that a time lies between; none: it does not.
  std::optional<std::size_t> after(Nanoseconds stamp) const;

  std::vector<Knot> knots_;
};

/// The longest time between two sweeps that what is between them is interpolated over, s.
inline constexpr double kLongestInterpolation = 1.0;

/// At a time between two poses that lie less far apart in time than that.
TrackedMotion between(const StampedPose& before, const StampedPose& after, Nanoseconds stamp);

}  // namespace adit
