// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Where a session is expected to begin in the map of earlier ones, before it has recognised
// anything there: because somebody says so, or by its GNSS fixes in a georeferenced map.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "adit/slam/gnss/map_fix.hpp"
#include "adit/slam/gnss/world_fit.hpp"
#include "adit/slam/gnss/world_frame.hpp"
#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

/// The lidar at the session's first sweep, as somebody guesses it: one sigma is 1 m horizontally,
/// 0.5 m in height and 5 degrees. Its tilt is the odometry's.
struct StartPlace {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m, map
  double heading = 0.0;  ///< rad, of its x axis, from the map's x axis
};

/// Of a pose that somebody guesses, right perturbation [rho, phi]: one sigma is 1 m and 5 degrees.
Matrix6d covariance_of_guess();

/// Where the odometry's frame, or a later map's, lies in the map, with what is not known of one
/// keyframe there. Not better than a guess: the datums of two sessions may differ.
struct ExpectedStart {
  Eigen::Isometry3d T_map_odom = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();  ///< of the keyframe's pose, right perturbation
};

/// Ties a node to one of the map, as the graph has both now.
PoseEdge start_edge(const PoseNode& map, const PoseNode& node, const Matrix6d& covariance);

/// `T_odom_lidar`: the odometry's pose of the first sweep.
ExpectedStart expected_start(const StartPlace& guess, const Eigen::Isometry3d& T_odom_lidar);

/// A map's place in the world with an error that all of its fixes may share: that of one of them.
Georeference with_shared_error(Georeference georeference, std::span<const MapFix> fixes);

/// Of a later map by the places of both in the world. `T_other_keyframe`: one of its keyframes.
ExpectedStart expected_start(const Georeference& map, const Georeference& other,
                             const Eigen::Isometry3d& T_other_keyframe);

/// Fixes of a session, in its odometry's frame, until they say where that lies in the map.
class StartByFixes {
 public:
  /// `georeference` is the map's. `correlation`: s, for which errors of fixes stay the same.
  /// `use_height`: fixes tell heights.
  StartByFixes(const Georeference& georeference, double correlation, bool use_height)
      : georeference_(georeference),
        frame_(georeference.origin),
        correlation_(correlation),
        use_height_(use_height) {}

  /// Of the next keyframe, in the order of their times. Positions that are none are passed over.
  void add(std::span<const MapFix> fixes, const Eigen::Isometry3d& T_odom_keyframe);
  /// Nothing kept, as after the odometry has started anew.
  void clear() { pairs_.clear(); }

  /// Nothing where most fixes do not agree on one place, or its heading is known worse than a guess
  /// would be. `up_odom`: the vertical in the odometry's frame. `T_odom_keyframe`: the newest one.
  std::optional<ExpectedStart> find(const Eigen::Vector3d& up_odom,
                                    const Eigen::Isometry3d& T_odom_keyframe) const;

 private:
  Georeference georeference_;
  WorldFrame frame_;
  double correlation_;
  bool use_height_;
  std::vector<PositionPair> pairs_;
};

}  // namespace adit
