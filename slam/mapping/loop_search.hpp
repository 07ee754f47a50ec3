// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Places of a map that the newest keyframe may have come back to, by what is known of where it is.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "adit/slam/mapping/relative_covariance.hpp"

namespace adit {

struct LoopSearchSettings {
  double gate = 7.815;           ///< chi squared of 3 directions: 95 % of true revisits are within
  double sigma_floor = 0.5;      ///< m, added to what the graph says of positions
  double least_dead_zone = 2.0;  ///< m: places so near each other see the same
  double dead_zone_share = 0.3;  ///< share of the lesser reach of both submaps, where that is more
  double lumps = 1.0;            ///< see relative_places()
  double max_distance = 50.0;    ///< m
  double min_path = 10.0;        ///< m, along the edges between the two
  std::size_t most = 5;
};

/// A place that might have been seen before.
struct LoopPlace {
  NodeId node = 0;
  Eigen::Isometry3d T_node_newest = Eigen::Isometry3d::Identity();  ///< as the graph has it
  Matrix6d covariance = Matrix6d::Zero();  ///< its own, right perturbation, the newest one's axes
  double distance = 0.0;                   ///< m
  double mahalanobis = 0.0;                ///< squared, of the distance beyond the dead zone
  double path = 0.0;                       ///< m, along edges
};

/// At most `most` places, the best of each stretch of consecutive nodes within the gate: the
/// nearest, whose submap has most in common with the newest one's. Nearest first. `reaches` are the
/// submaps' (m), in the order of the graph's nodes: half of a submap's points are nearer.
std::vector<LoopPlace> find_loop_places(const PoseGraph& graph, NodeId newest,
                                        std::span<const double> reaches,
                                        const LoopSearchSettings& settings);

}  // namespace adit
