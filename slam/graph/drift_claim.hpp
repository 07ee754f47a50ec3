// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Whether the odometry may have drifted by as much as a loop claims: the sign by which places that
// look alike are told from places seen again (docs/theory/loops.md).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

/// What an odometry drifts by at the most, far beyond what its covariances say.
struct DriftLimits {
  double aside = 0.05;   ///< m, horizontally, a metre of path
  double height = 0.15;  ///< m a metre of path
  double turn = 0.0035;  ///< rad a metre of path (0.2 degrees)
  double tilt = 0.035;   ///< rad between two places that know their vertical, whatever the path
  // What a pair of places that are taken for the same may be apart:
  double least_distance = 0.5;  ///< m
  double least_turn = 0.05;     ///< rad
};

/// `error` is what the poses of two places, a path of so many m apart, would have drifted by.
/// `levelled`: its first frame has z up. Its tilt does not count then: an optimisation may have put
/// it there. Else nobody knows what height is: the larger limit counts in all directions, and the
/// whole turn.
bool is_possible_drift(const Eigen::Isometry3d& error, double path, const DriftLimits& limits = {},
                       bool levelled = true);

/// Between two places that know their vertical there is more tilt than an alignment may err by.
bool is_tilted(const Eigen::Isometry3d& T_from_to, const DriftLimits& limits = {});

/// A loop claims that the stretch that led to the later keyframe is the one that led to the earlier
/// one, as far back as the two lie together and no accepted loop ties them: the drift has to be
/// possible for each such pair, and where both know their vertical (`levelled`), nothing explains a
/// tilt. (On the way back the stretches are followed no farther: drift grows
/// along them, and how, no loop says.) Paths are the shortest along the graph's edges, loops
/// included: drift since then is what is claimed, of what these edges have measured, since an
/// optimisation may have bent some of them for a loop far away. True where there is none between
/// the two keyframes.
bool drift_explains(const PoseGraph& graph, NodeId from, NodeId to,
                    const Eigen::Isometry3d& T_from_to, const DriftLimits& limits = {},
                    bool levelled = true);

/// For each node, in the graph's order: whether an active loop goes from it or one before it to one
/// behind it, so that the odometry's edge to the next is one that loops have corrected.
std::vector<bool> within_loops(const PoseGraph& graph);

/// How far the odometry has climbed too much, as a loop claims.
struct ClaimedClimb {
  double climb = 0.0;   ///< m
  double length = 0.0;  ///< m, of the shortest way; infinite where nothing ties the keyframes
  double way = 0.0;     ///< m of it that no loop has corrected yet, less what goes back in time
};
ClaimedClimb claimed_climb(const PoseGraph& graph, NodeId from, NodeId to,
                           const Eigen::Isometry3d& T_from_to);

/// How far the odometry alone has climbed too much on its whole way between two keyframes, as a
/// loop has it: whatever other loops have corrected of that. Nothing where it was not tied to the
/// earlier keyframe all the way.
std::optional<ClaimedClimb> climb_of_odometry(const PoseGraph& graph, NodeId from, NodeId to,
                                              const Eigen::Isometry3d& T_from_to);

/// Drift that a loop claims, and the way on which it came to pass.
struct ClaimedDrift {
  /// m, in the map's axes: where the graph has the later keyframe, less where the loop has it.
  Eigen::Vector3d off = Eigen::Vector3d::Zero();
  double way = 0.0;  ///< m, the shortest between the keyframes; infinite where nothing ties them
};
ClaimedDrift claimed_drift(const PoseGraph& graph, NodeId from, NodeId to,
                           const Eigen::Isometry3d& T_from_to);

/// Whether claims grow as their ways do, from nothing on: as drift does on the way back along a
/// stretch. Another place that looks the same is as far off at the first keyframe as at the last.
/// False where the ways are too much alike to tell.
bool grows_with_way(std::span<const ClaimedDrift> claims);

/// What accepted loops have shown of the odometry's climb: the next claims are held against it,
/// since floors that are built alike lie within what an odometry may drift by at the most.
class ShownClimb {
 public:
  /// By the odometry's own way.
  void add(const ClaimedClimb& accepted);
  /// True as well as long as little has been shown.
  bool allows(const ClaimedClimb& claim) const;
  /// It climbs, and everywhere as much: what nothing but the graph bears out has to do so, too.
  bool is_steady() const;

 private:
  double rate() const;     ///< m a metre
  double scatter() const;  ///< of it, as a share

  double squared_way_ = 0.0;    ///< m²
  double way_climb_ = 0.0;      ///< m²
  double squared_climb_ = 0.0;  ///< m²
};

}  // namespace adit
