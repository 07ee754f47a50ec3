// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "adit/slam/core/lie.hpp"
#include "adit/slam/core/types.hpp"

namespace adit {

/// Velocity and turning rate of the range sensor, its axes.
struct DopplerTwist {
  Vector6d rate = Vector6d::Zero();            ///< [v, w], m/s and rad/s
  Matrix6d covariance = Matrix6d::Identity();  ///< of that
};

/// What the Doppler speeds of a sweep's points say.
struct DopplerFit {
  BodyVelocity velocity;            ///< of the range sensor, its axes, at the sweep's middle
  std::vector<std::size_t> moving;  ///< points that are not at rest, in their order
  std::size_t used = 0;             ///< points with a speed that the fit was made from
  DopplerTwist twist{};             ///< the turning rate is known of sensors in several places
};

/// The velocity of the sensor with which most points are at rest: doppler = -d . v(t), d the
/// direction to the point and v(t) linear in time, by the sample of points that most agree with,
/// then by least squares with Cauchy's kernel (docs/theory/velocity.md, section 3); its covariance
/// says which directions the points do not determine. Nothing where fewer than twelve points have
/// a speed, or where less than half of them agree. The samples are the same for the same points.
///
/// `origins`: of sweeps that several sensors made, where these are (m, axes of the points); `rings`
/// then is the number of a point's sensor. A sensor at l goes v + w x l, so that two of them
/// determine the turning rate w, too (D. Kellner et al., "Instantaneous ego-motion estimation using
/// multiple Doppler radars", ICRA 2014).
std::optional<DopplerFit> fit_doppler(const Sweep& sweep,
                                      std::span<const Eigen::Vector3d> origins = {});

}  // namespace adit
