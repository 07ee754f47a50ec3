// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Geometry>

#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// T_imu_lidar as the recording's static transforms tell it: maps coordinates in the frame of the
/// sweeps' messages to the frame of the IMU's. None where the recording has no transforms or does
/// not name the frames; reads up to the first message of each topic, and the transforms of the
/// first ten seconds.
std::optional<Eigen::Isometry3d> recorded_mounting(const Recording& recording,
                                                   std::size_t sweep_topic, std::size_t imu_topic);

}  // namespace adit
