// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "adit/slam/core/types.hpp"

namespace adit {

/// What the Doppler speeds of a sweep's points say.
struct DopplerFit {
  BodyVelocity velocity;            ///< of the range sensor, its axes, at the sweep's middle
  std::vector<std::size_t> moving;  ///< points that are not at rest, in their order
  std::size_t used = 0;             ///< points with a speed that the fit was made from
};

/// The velocity of the sensor with which most points are at rest: doppler = -d . v(t), d the
/// direction to the point and v(t) linear in time, by least squares with Cauchy's kernel
/// (docs/theory/velocity.md, section 3); its covariance says which directions the points do not
/// determine. Nothing where fewer than twenty points have a speed.
std::optional<DopplerFit> fit_doppler(const Sweep& sweep);

}  // namespace adit
