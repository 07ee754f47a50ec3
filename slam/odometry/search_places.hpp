// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "adit/slam/odometry/motion_model.hpp"

namespace adit {

/// A search starts from so many places at most.
inline constexpr size_t kMostPlaces = 13;

/// Where the alignment of the next sweep is searched from besides the predicted pose itself,
/// T_map_lidar: nowhere with a trusted prediction; there coarse to fine with one that is not; of a
/// lost sensor, and after a silence, with eight headings, ahead, behind, on both sides, and where
/// its velocity would have led.
std::vector<Eigen::Isometry3d> places_to_search(const Prediction& prediction,
                                                const std::optional<Silence>& silence = {});

/// Ways a sensor may have moved since the last sweep.
struct PossibleMotions {
  Eigen::Isometry3d predicted = Eigen::Isometry3d::Identity();  ///< T_map_lidar
  Eigen::Isometry3d steady = Eigen::Isometry3d::Identity();     ///< at constant velocity
  Eigen::Isometry3d at_rest = Eigen::Isometry3d::Identity();    ///< where the last sweep was
};

/// The same where a trusted prediction led to an alignment that falls short: from each of the
/// motions, from the middle, and with other headings than at rest and at constant velocity.
std::vector<Eigen::Isometry3d> places_after_rejection(const PossibleMotions& motions);

}  // namespace adit
