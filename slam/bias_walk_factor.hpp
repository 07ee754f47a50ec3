// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slam/imu_noise.hpp"
#include "slam/linearization.hpp"

namespace adit {

/// Biases walk at random: rows [gyro, accel], the change over `duration` (s, greater than 0) by its
/// standard deviation.
LinkFactor<6> bias_walk_factor(const ImuNoise& noise, double duration, const NavState& from,
                               const NavState& to);

}  // namespace adit
