// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/types.hpp"
#include "adit/tools/map_products/cloud_selection.hpp"

namespace adit {

/// The path of a sensor, T_map_lidar at any time: between two poses at constant velocity.
class SensorPath {
 public:
  /// In any order of their stamps.
  explicit SensorPath(std::vector<StampedPose> poses);

  /// The poses of one sweep's points.
  class Stretch {
   public:
    /// `after`: s after the sweep's stamp.
    Eigen::Isometry3d at(double after) const;

   private:
    friend class SensorPath;
    Eigen::Isometry3d T_map_lidar_;
    Vector6d velocity_;  // [rho, phi], m/s and rad/s in the lidar's frame
  };

  /// From the pose with this stamp to the next; the last one, or one before a gap of more than
  /// 0.5 s, moves on as before it. None where no pose has this stamp.
  std::optional<Stretch> from(Nanoseconds stamp) const;

  /// T_map_lidar at any time, by the pose before it. None before the first pose, or more than 0.5 s
  /// after a pose.
  std::optional<Eigen::Isometry3d> at(Nanoseconds time) const;

 private:
  std::vector<StampedPose> poses_;  // in order
};

/// The returns of a sweep in the map's frame, each from where the sensor was at its time.
std::vector<CloudPoint> placed_points(const Sweep& sweep, const SensorPath::Stretch& path);

}  // namespace adit
