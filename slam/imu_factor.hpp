// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slam/linearization.hpp"
#include "slam/preintegration.hpp"

namespace adit {

/// What was preintegrated against the two states it lies between: rows [position, rotation,
/// velocity], whitened with the increment's covariance. `gravity` in the map, m/s². After Forster
/// et al., T-RO 2017; the bias is the first state's.
LinkFactor<9> imu_factor(const Preintegration& preintegration, const Eigen::Vector3d& gravity,
                         const NavState& from, const NavState& to);

}  // namespace adit
