// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adit/slam/core/imu_noise.hpp"
#include "adit/slam/fusion/linearization.hpp"

namespace adit {

/// Rows [gyro bias, accel bias, gravity, velocity calibration]: the change over `duration` (s,
/// greater than 0) by its standard deviation. Gravity's are those of its unit vector, whose
/// direction in the map has walked by `gravity_sigma`, rad, greater than 0.
LinkFactor<12> walk_factor(const ImuNoise& noise, double gravity_sigma, double duration,
                           const NavState& from, const NavState& to);

}  // namespace adit
