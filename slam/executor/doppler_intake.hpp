// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "adit/slam/inertial/doppler_velocity.hpp"
#include "adit/slam/odometry/odometry.hpp"
#include "adit/slam/registration/radar_aligner.hpp"

namespace adit {

/// Gives the odometry what the Doppler speeds of a sweep say, and takes the points that move out of
/// it, as without a return: how many. `origins`: of radars whose scans were merged (fit_doppler()).
inline std::size_t take_doppler(Sweep& sweep, std::span<const Eigen::Vector3d> origins,
                                Odometry& odometry) {
  const bool several = origins.size() > 1 && is_radar_scan(sweep);
  const auto fit = fit_doppler(sweep, several ? origins : std::span<const Eigen::Vector3d>());
  if (!fit) {
    return 0;
  }
  odometry.add(fit->velocity, VelocitySource::doppler);
  odometry.add(fit->twist);
  for (const std::size_t i : fit->moving) {
    sweep.points[i] = Point{};
  }
  return fit->moving.size();
}

}  // namespace adit
