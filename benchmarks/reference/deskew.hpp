// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Twin of deskew.comp.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "adit/engine/kernels/deskew.hpp"
#include "adit/slam/core/types.hpp"

namespace adit::reference {

/// Points at the sweep's start, (0, 0, 0) where there is none: m. Between poses at equally spaced
/// times rotations go along the shortest arc at a constant rate.
inline std::vector<Eigen::Vector3d> deskew(std::span<const Point> raw, std::span<const float> times,
                                           std::span<const Eigen::Isometry3d> T_start_lidar,
                                           const engine::DeskewSettings& settings) {
  std::vector<Eigen::Vector3d> result(raw.size(), Eigen::Vector3d::Zero());
  const double span = settings.last_time - settings.first_time;
  const auto last = static_cast<double>(T_start_lidar.size() - 1);
  for (size_t i = 0; i < raw.size(); ++i) {
    const Eigen::Vector3d p = Eigen::Vector3f(raw[i].x, raw[i].y, raw[i].z).cast<double>();
    const double range = p.norm();
    if (!std::isfinite(range) || !std::isfinite(times[i]) || range == 0.0 ||
        range < settings.c_min || range > settings.c_max) {
      continue;
    }
    const double place = std::fmin(
        std::fmax((static_cast<double>(times[i]) - settings.first_time) / span * last, 0.0), last);
    const double below = std::fmin(std::floor(place), last - 1.0);
    const Eigen::Isometry3d& a = T_start_lidar[static_cast<size_t>(below)];
    const Eigen::Isometry3d& b = T_start_lidar[static_cast<size_t>(below) + 1];
    const double share = place - below;
    const Eigen::Quaterniond q =
        Eigen::Quaterniond(a.linear()).slerp(share, Eigen::Quaterniond(b.linear()));
    result[i] = q * p + (1.0 - share) * a.translation() + share * b.translation();
  }
  return result;
}

}  // namespace adit::reference
