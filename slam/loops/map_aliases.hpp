// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a map looks like itself: equal floors, wings or houses; and how a place that is seen again
// differs from one that merely looks the same.
#pragma once

#include <span>
#include <vector>

#include "adit/slam/graph/pose_graph.hpp"
#include "adit/slam/loops/loop_candidate.hpp"

namespace adit {

/// Shares of points that one of two submaps sees through in the other, on average over pairs of
/// submaps.
struct ThroughShares {
  double right = 0.0024;  ///< of the same place, seen in another session
  double alike = 0.0135;  ///< of places that only look the same
};

/// A displacement under which places of a map look like other places of it.
class MapAlias {
 public:
  /// At one place.
  struct Measured {
    Eigen::Vector3d at;               ///< m, map
    Eigen::Isometry3d T_alias_place;  ///< moves the place to the one that it looks like, map axes
    double through = 0.0;             ///< share of points that one sees through in the other
  };

  /// It is the same displacement.
  bool agrees(const Measured& other) const;
  void add(const Measured& measured) { measured_.push_back(measured); }

  /// What looks like a place of the map would, were it there: a pose in the map, and the pose that
  /// it looks like. Of the displacements that were measured, that at the nearest place counts.
  Eigen::Isometry3d moved(const Eigen::Isometry3d& T_map_place) const;

  std::size_t places() const { return measured_.size(); }
  double mean_through() const;  ///< ThroughShares::alike of these places

 private:
  const Measured& nearest(const Eigen::Vector3d& at) const;

  std::vector<Measured> measured_;
};

struct MapAliases {
  std::vector<MapAlias> all{};
  /// No less than the map's accepted loops have it, where there are enough of them. Places that
  /// look the same are seen through as many times more as where this was measured.
  ThroughShares through{};
};

/// From what the search for loops has found in the map: places that its submaps bear out, and that
/// the odometry, other loops or other places contradict. The most frequent first, in both
/// directions each.
MapAliases map_aliases(const PoseGraph& graph, std::span<const LoopCandidate> candidates);

/// Natural logarithm of the likelihood of shares that are seen through at some places, if these are
/// the same places as in another map, over that if they are only built alike: then an unknown part
/// of them is equal in every detail. Any part is as likely, so that it is integrated out.
double log_ratio_to_built_alike(std::span<const double> through, const ThroughShares& shares);

}  // namespace adit
