// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the numbers of a simulation may be. Each function throws UsageError, which says what its
// number is and must be; whoever calls it knows where the number stands.
#pragma once

#include <span>

#include <Eigen/Core>

#include "adit/tools/simulator/motion.hpp"

namespace adit {

void require_duration(double seconds);
void require_change(double share);          ///< of movable objects
void require_later(double seconds);         ///< after the simulation's epoch
void require_speed(double speed);           ///< m/s
void require_begin(double distance);        ///< m along the way
void require_corner_radius(double radius);  ///< m
void require_size(double size);             ///< m, of a heap
void require_imu_rate(int rate);            ///< Hz
void require_gnss_rate(int rate);           ///< Hz
void require_wheel_rate(int rate);          ///< Hz
void require_camera_rate(int rate);         ///< Hz
void require_wheels(const MotionStyle& style);

/// The corners of a closed way on the floor, of which the last is followed by the first: it must
/// have a direction everywhere.
void require_way(std::span<const Eigen::Vector3d> corners);

}  // namespace adit
