// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slam/imu_noise.hpp"
#include "slam/linearization.hpp"

namespace adit {

/// What walks at random from one state to the next.
struct WalkNoise {
  ImuNoise imu;
  double gravity = 1e-4;  ///< of its direction in the map, which drifts: rad/√s
};

/// Rows [gyro bias, accel bias, gravity]: the change over `duration` (s, greater than 0) by its
/// standard deviation. Gravity's are those of its unit vector.
LinkFactor<9> walk_factor(const WalkNoise& noise, double duration, const NavState& from,
                          const NavState& to);

}  // namespace adit
