// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How far the odometry, and how far the map, is from what a loop has measured.
#pragma once

#include <map>
#include <optional>

#include "adit/slam/graph/pose_graph.hpp"
#include "adit/slam/mapping/map_store.hpp"

namespace adit {

/// A keyframe where the odometry alone has it, from the first one of its chain.
struct ChainPlace {
  std::size_t chain = 0;                                   ///< those of another are not tied to it
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< of the first one's axes
  double path = 0.0;                                       ///< m, along the edges
};

/// Where the odometry's edges alone have each keyframe.
std::map<NodeId, ChainPlace> chain_places(const PoseGraph& graph);

/// A relative pose of a loop's two keyframes beside the measured one.
struct PoseBeside {
  Eigen::Isometry3d T_from_to = Eigen::Isometry3d::Identity();
  double metres = 0.0;   ///< from the measured one
  double radians = 0.0;  ///< from the measured one
};

/// What the odometry alone and the map say of a loop.
struct LoopDrift {
  std::optional<PoseBeside> odometry{};  ///< nothing: its edges do not lead from one to the other
  double path = 0.0;                     ///< m of odometry between the two
  PoseBeside map{};                      ///< as last optimised
};

/// Both keyframes have to be in the graph that the places are of.
LoopDrift drift_of(const LoopCandidate& loop, const std::map<NodeId, ChainPlace>& places,
                   const PoseGraph& graph);

}  // namespace adit
