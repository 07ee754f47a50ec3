// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adit/slam/fusion/linearization.hpp"
#include "adit/slam/inertial/measured_displacement.hpp"

namespace adit {

/// The way of the sensor of velocities between two states, against the one that was measured with
/// the later state's calibration (docs/theory/velocity.md, equation 2), whitened.
LinkFactor<3> velocity_factor(const MeasuredDisplacement& measured, const NavState& from,
                              const NavState& to);

/// Its kernel: Cauchy's, which takes slipping wheels for what they are.
RobustWeight velocity_kernel(const LinkFactor<3>& factor);

}  // namespace adit
