// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Places of a map that the newest keyframe may have come back to, by what is known of where it is.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "adit/slam/graph/relative_covariance.hpp"
#include "adit/slam/loops/loop_candidate.hpp"
#include "adit/slam/loops/place_index.hpp"

namespace adit {

struct LoopSearchSettings {
  double gate = 7.815;           ///< chi squared of 3 directions: 95 % of true revisits are within
  double sigma_floor = 0.5;      ///< m, added to what the graph says of positions
  double least_dead_zone = 2.0;  ///< m: places so near each other see the same
  double dead_zone_share = 0.3;  ///< share of the lesser reach of both submaps, where that is more
  double max_distance = 50.0;    ///< m
  double min_path = 10.0;        ///< m, along the edges between the two,
  double detour = 2.0;           ///< and besides so many times their distance: else one went on
  std::size_t most = 5;
  /// So many of the graph's first nodes belong to earlier sessions: nobody went on from there to
  /// the newest one, however short the path along edges is.
  std::size_t earlier_nodes = 0;
  bool earlier_alone = false;  ///< places of other nodes are not looked for
};

/// A place that might have been seen before.
struct LoopPlace {
  NodeId node = 0;
  LoopSource source = LoopSource::position;
  /// As the graph has it, or as the place looks.
  Eigen::Isometry3d T_node_newest = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();  ///< its own, right perturbation, the newest one's axes
  double distance = 0.0;                   ///< m
  /// By position: squared Mahalanobis distance beyond the dead zone. By appearance: the share of
  /// the plan's cells that fall on those of the place.
  double score = 0.0;
  double path = 0.0;  ///< m, along edges; 0: there are none between the two
};

/// At most `most` places, the best of each stretch of consecutive nodes within the gate: the
/// nearest, whose submap has most in common with the newest one's. Nearest first. `known` are
/// relative_places() of the newest, `reaches` the submaps' (m): half of a submap's points are
/// nearer. Both in the order of the graph's nodes.
std::vector<LoopPlace> find_loop_places(const PoseGraph& graph, NodeId newest,
                                        std::span<const std::optional<RelativePlace>> known,
                                        std::span<const double> reaches,
                                        const LoopSearchSettings& settings);

struct AppearanceSearchSettings {
  double min_path = 10.0;  ///< m, along the edges between the two, where there are any,
  double detour = 2.0;     ///< and besides so many times their distance
  double least_similarity = 0.6;
  double least_likeness = 0.6;
  std::size_t most_correlated = 3;
  std::size_t most = 2;
  std::size_t apart = 5;          ///< nodes: nearer ones are the same place
  std::size_t earlier_nodes = 0;  ///< as of LoopSearchSettings
  bool earlier_alone = false;     ///< the same
};

/// At most `most` places that look like the newest one, which the index knows by the numbers of the
/// graph's nodes: the best of those that are `apart` from each other. Most alike first.
std::vector<LoopPlace> find_similar_places(const PoseGraph& graph, const PlaceIndex& index,
                                           std::span<const std::optional<RelativePlace>> known,
                                           const AppearanceSearchSettings& settings);

}  // namespace adit
