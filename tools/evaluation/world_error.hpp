// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How far a georeferenced map lies from where it is in the world: without any alignment.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "adit/slam/core/types.hpp"
#include "adit/tools/evaluation/evaluate_metrics.hpp"
#include "adit/tools/results/trajectory_io.hpp"

namespace adit {

struct WorldError {
  Statistics horizontal;                           ///< m, of sweeps
  Statistics vertical;                             ///< m, absolute
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();  ///< m, east north up
  /// Of keyframes' positions, a degree of freedom: 1 where the graph's covariances are right.
  double nees = 0.0;
  std::size_t judged = 0;  ///< keyframes, for nees
};

/// `truth_origin`: the truth's frame is east, north and up in the plane that touches the Earth
/// there. `tolerance` (s) as for associate(). Throws InputError: the map has no place in the world,
/// or nothing matches.
WorldError world_error(const std::filesystem::path& map, const Trajectory& truth,
                       const Geodetic& truth_origin, double tolerance);

std::string describe(const WorldError& error);
nlohmann::ordered_json to_json(const WorldError& error);

}  // namespace adit
