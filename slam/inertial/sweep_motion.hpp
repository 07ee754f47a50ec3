// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "adit/shaders/shared/deskew.h"
#include "adit/slam/core/nav_state.hpp"

namespace adit {

/// Where the lidar was during a sweep: poses at equally spaced times from `first` to `last` (s
/// after the sweep's stamp), in the lidar's frame at the stamp.
struct SweepMotion {
  double first = 0.0;
  double last = 0.0;
  std::vector<Eigen::Isometry3d> T_start_lidar;  ///< two or more
};

/// Poses that a sweep is de-skewed with. 1.6 ms apart in a tenth of a second: at 2 rad/s and
/// 20 m/s² interpolation errs by less than 0.01 mm at 10 m.
constexpr int kMotionKnots = 64;

/// A constant twist of the lidar in its own axes, [m/s, rad/s].
SweepMotion steady_motion(const Vector6d& twist, double first, double last);

/// What inertial readings say. `state` is the body's at the sweep's stamp, with the biases that are
/// subtracted; `readings` begin at the stamp, in m/s². Past the last reading velocity and angular
/// velocity stay as they were.
SweepMotion inertial_motion(const NavState& state, std::span<const ImuSample> readings,
                            const Eigen::Isometry3d& T_body_lidar, double first, double last);

/// The same for the device (float32: a sweep is local).
std::vector<gpu::DeskewKnot> knots(const SweepMotion& motion);

/// From the attitude at the start to the mean one: rotation vector, rad.
Eigen::Vector3d mean_turn(const SweepMotion& motion);

}  // namespace adit
