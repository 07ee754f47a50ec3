// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adit/slam/fusion/linearization.hpp"
#include "adit/slam/inertial/preintegration.hpp"

namespace adit {

/// What was preintegrated against the two states it lies between: rows [position, rotation,
/// velocity], whitened with the increment's covariance. After Forster et al., T-RO 2017; biases and
/// gravity are the first state's.
LinkFactor<9> imu_factor(const Preintegration& preintegration, const NavState& from,
                         const NavState& to);

}  // namespace adit
