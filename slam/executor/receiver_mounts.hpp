// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <optional>

#include "adit/slam/core/config.hpp"
#include "adit/slam/core/lie.hpp"

namespace adit {

/// Where a receiver's antenna sits and which way its headings point, in the lidar's axes: as the
/// settings say, else by a transform T_lidar_sensor, which is looked for until it is found, since
/// it may arrive after the first measurement, else the lidar's own place and x axis.
class ReceiverMounts {
 public:
  explicit ReceiverMounts(const GnssConfig& config) {
    if (config.antenna) {
      antenna_ = Eigen::Vector3d(config.antenna->data());
    }
    if (const std::optional<double>& yaw = config.heading_mounting) {
      heading_axis_ = Eigen::Vector3d(std::cos(*yaw), std::sin(*yaw), 0.0);
    }
  }

  using Transform = std::function<std::optional<Eigen::Isometry3d>()>;

  /// m.
  Eigen::Vector3d antenna(const Transform& T_lidar_sensor) {
    if (const auto T = antenna_ ? std::nullopt : T_lidar_sensor()) {
      antenna_ = Eigen::Vector3d(T->translation());
    }
    return antenna_.value_or(Eigen::Vector3d::Zero());
  }

  /// The x axis of the sensor of headings.
  Eigen::Vector3d heading_axis(const Transform& T_lidar_sensor) {
    if (const auto T = heading_axis_ ? std::nullopt : T_lidar_sensor()) {
      heading_axis_ = Eigen::Vector3d(T->linear().col(0));
    }
    return heading_axis_.value_or(Eigen::Vector3d::UnitX());
  }

 private:
  std::optional<Eigen::Vector3d> antenna_;
  std::optional<Eigen::Vector3d> heading_axis_;
};

}  // namespace adit
