// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a map lies in the world, from positions alone: the start of what the graph then refines.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "adit/slam/core/lie.hpp"

namespace adit {

/// A point as the map and as a receiver have it.
struct PositionPair {
  Eigen::Vector3d p_map = Eigen::Vector3d::Zero();           ///< m; z is up
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();         ///< m
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of p_world, m^2
  double time = 0.0;                                         ///< s, increasing
};

struct WorldFit {
  Eigen::Isometry3d T_world_map = Eigen::Isometry3d::Identity();  ///< a yaw and a translation
  double yaw_sigma = 0.0;    ///< rad, with errors that stay the same for `correlation`
  std::vector<bool> agrees;  ///< each pair, within its error and the map's drift
  std::size_t agreeing = 0;
};

/// The yaw and translation that most pairs agree with (consensus over pairs of pairs), then that of
/// least squares over those (closed form; docs/theory/gnss.md). None: fewer than three agree, or
/// all lie at one place.
std::optional<WorldFit> fit_world(std::span<const PositionPair> pairs, double correlation);

}  // namespace adit
