// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Are the range sensors of a recording mounted to each other as its settings or transforms say? The
// sweeps of one are aligned with what the other has mapped.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "adit/engine/context.hpp"
#include "adit/slam/core/config.hpp"
#include "adit/slam/core/lie.hpp"
#include "adit/tools/inspection/recording_findings.hpp"
#include "adit/tools/recordings/merged_sweeps.hpp"
#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// How a further range sensor lies in the axes of the first.
struct LidarMounting {
  std::string topic;                                           ///< of the further sensor
  std::string to_topic;                                        ///< of the first
  Eigen::Isometry3d expected = Eigen::Isometry3d::Identity();  ///< T_lidar_sensor, as it is given
  std::size_t compared = 0;                                    ///< sweeps of the further sensor
  std::size_t aligned = 0;  ///< those that were aligned with the other's map
  /// T_lidar_sensor by the sweeps; none: too few of them could be aligned.
  std::optional<Eigen::Isometry3d> found{};
  /// Of `found`, right perturbation [rho, phi] in the sensor's axes (m, rad), with the scatter of
  /// the sweeps.
  Matrix6d covariance = Matrix6d::Identity();
};

/// Maps the first 10 s of sweeps of `first`, and aligns up to 20 sweeps of `further` with that map.
/// Damaged places are passed over. Throws engine::Error.
LidarMounting check_lidar_mounting(const Recording& recording, const MergedTopic& first,
                                   const MergedTopic& further, const Config& config,
                                   engine::Context& context);

/// A mounting that the sweeps contradict, or one that could not be checked.
std::vector<Finding> find_in_mounting(const LidarMounting& mounting);

/// One line for people.
std::string describe(const LidarMounting& mounting);

}  // namespace adit
