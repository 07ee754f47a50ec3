// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "adit/slam/core/lie.hpp"

namespace adit {

/// Where the next sweep is expected, and whether to trust it.
struct Prediction {
  Eigen::Isometry3d T_map_lidar = Eigen::Isometry3d::Identity();
  /// The velocity is known from aligned sweeps. If not, the alignment has to search.
  bool trusted = false;
  /// A velocity is known from one motion at least, and recent.
  bool moving = false;
  /// Nothing tells how the sensor moved since it was last aligned: it may be anywhere nearby.
  bool lost = false;
  /// Where the last velocity would have led in all that time: of a lost sensor another place to
  /// look at.
  Eigen::Isometry3d T_map_onward = Eigen::Isometry3d::Identity();
  /// Information that a trusted prediction has of [rho, phi], lidar axes, in units of the matches'
  /// Hessian: every step of the alignment weighs it against the matches. None: the prediction
  /// decides only where no match holds the pose, by `sigma`.
  std::optional<Matrix6d> information = std::nullopt;
  /// How well the pose is known where no match holds it: standard deviations of [rho, phi], m and
  /// rad, lidar axes. A constant velocity's by default.
  Vector6d sigma = (Vector6d() << 0.1, 0.1, 0.1, 0.02, 0.02, 0.02).finished();
};

}  // namespace adit
