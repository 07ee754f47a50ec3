// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include <Eigen/Core>

#include "adit/tools/map_database/map_database.hpp"
#include "adit/tools/results/trajectory_io.hpp"

namespace adit {

/// A true trajectory laid over a map.
struct TruthOnMap {
  std::map<NodeId, double> errors;  ///< m, of the keyframes that the truth covers
  /// The true way in the map's frame, m: parts of a map that nothing ties together have their own.
  std::vector<Eigen::Vector3d> path;
};

/// Each part of the map (connected_components()) is laid onto the truth by itself, by all positions
/// of its keyframes (Umeyama 1991), or where these do not determine that, by its first pose.
/// `truth` has stamps and is in their order. Throws InputError: damaged, or the truth covers none.
TruthOnMap truth_on_map(const MapDatabase& map, const Trajectory& truth);

}  // namespace adit
