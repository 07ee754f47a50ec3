// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A pose graph whose truth is known: a walk through the streets of a grid, a node each metre, and
// loops where it comes by a place again.
#pragma once

#include <cstdint>
#include <vector>

#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

struct SimulatedGraphSettings {
  std::size_t nodes = 1000;
  std::size_t loops = 100;  ///< at most; fewer where the walk comes by fewer places again
  uint64_t seed = 1;
  bool planar = false;
  int streets = 0;  ///< in each direction, 50 m apart; 0: as many as fit the number of nodes
  double odometry_sigma = 0.02;         ///< m an edge
  double odometry_angle_sigma = 0.001;  ///< rad an edge
  double loop_sigma = 0.05;             ///< m
  double loop_angle_sigma = 0.003;      ///< rad
};

struct SimulatedGraph {
  PoseGraph graph;  ///< nodes from dead reckoning: each at the end of the odometry before it
  std::vector<Eigen::Isometry3d> truth;
};

/// The same graph on every machine but for the last digits of sines and cosines.
SimulatedGraph simulated_graph(const SimulatedGraphSettings& settings);

/// Root mean square distance of positions, in m, both from the first node's frame.
double position_rmse(const std::vector<Eigen::Isometry3d>& poses,
                     const std::vector<Eigen::Isometry3d>& truth);

}  // namespace adit
