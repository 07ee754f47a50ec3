// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Which of the verified loops of the last keyframes agree with each other, with the odometry and
// with the loops that were accepted before (docs/theory/loops.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "adit/slam/graph/implied_drift.hpp"
#include "adit/slam/graph/tracking_gap.hpp"
#include "adit/slam/loops/loop_candidate.hpp"

namespace adit {

/// A loop that its submaps bear out: a measured pose of the later keyframe in the earlier one's
/// frame.
struct LoopHypothesis {
  int64_t id = 0;
  NodeId from = 0;  ///< the earlier keyframe
  NodeId to = 0;    ///< the later one
  Eigen::Isometry3d T_from_to = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Identity();  ///< its covariance, right perturbation
  bool strong = false;  ///< may be accepted alone: all directions constrained, much in common
  LoopSource source = LoopSource::position;
  /// When it was found, the graph did not know how the two are turned to each other.
  bool without_heading = false;
  bool levelled = true;  ///< both know their vertical: tilts and heights tell something
};

struct LoopVotingSettings {
  double agreement = 12.59;  ///< chi squared of 6 directions that two loops agree within: 95 %
  double contradiction =
      16.81;  ///< and beyond which odometry or an accepted loop contradicts: 99 %
  /// See relative_places(): of ways over odometry that are no neighbours. Measured on the simulated
  /// office's odometry, over 20 to 40 edges (docs/theory/loops.md).
  double lumps = 4.0;
  std::size_t least_voters = 3;      ///< distinct later keyframes
  std::size_t least_unexpected = 4;  ///< the same, of what the odometry does not bear out
  double gap = 11.34;          ///< chi squared of what is claimed of a gap, 3 directions: 99 %
  double gap_sigma = 0.2;      ///< m, besides what is known of the ways to its ends
  double least_apart = 10.0;   ///< m, between two later keyframes that tie parts of a map, or
  double least_turned = 1.0;   ///< rad
  double heading_sigma = 1.0;  ///< rad, from where on the graph does not know a heading
  double least_aside = 3.0;  ///< m, from the line of a bundle's later keyframes, where it does not
  /// Logarithm of the least odds that what contradicts the odometry's covariances is a place seen
  /// again and no alias: 20 to 1. Before, both are as likely: of 200 wrong pairs of the simulated
  /// office 186 pass verification (docs/theory/loops.md). Neighbouring keyframes of an alias agree
  /// as well as those of a revisit do, so that a bundle is as likely as each of its loops.
  double least_log_odds = 3.0;
  /// A loop that claims more climb than this, m and m a metre, and fits the odometry in all else,
  /// is another floor: what drifts is off elsewhere, too.
  double another_floor = 0.5;
  double another_floor_share = 0.01;
  double most_contradicting = 0.25;  ///< share of the accepted loops that may
  std::size_t most_asked = 50;       ///< accepted loops that are asked, the latest
};

/// Why a loop has not been accepted.
enum class LoopObjection {
  none,
  odometry,  ///< contradicts what the graph knows without it
  loops,     ///< contradicts loops that were accepted before
  places,    ///< others agree as well that it is another place
  voters,    ///< too few others agree by now
};

struct LoopVote {
  LoopObjection objection = LoopObjection::voters;
  double odometry_chi2 = 0.0;  ///< against the graph, or the gaps between its parts
  double worst_chi2 = 0.0;     ///< against the loops it was accepted with, or that contradict it
  std::size_t voters = 1;      ///< later keyframes that agree, its own among them
  bool unexpected = false;     ///< not where the graph's covariances have it
  bool blind = false;          ///< the graph does not know its heading
  bool accepted = false;
};

/// Loops that came before.
struct EarlierLoops {
  std::span<const LoopHypothesis> accepted{};  ///< the graph's
  std::span<const LoopHypothesis> refuted{};   ///< that no drift can explain
  std::span<const TrackingGap> gaps{};         ///< between parts of the graph
  OdometryDrift drift{};                       ///< as the accepted ones have shown it
  /// So many of the graph's first nodes belong to earlier sessions. What ties others to them is
  /// held against other places by the closer: competing bundles are not asked here.
  std::size_t earlier_nodes = 0;
};

/// A vote per hypothesis, in order. Those of one bundle are accepted together: at least
/// `least_voters`, one for each later keyframe, each agreeing with each. `graph` has not seen them.
/// `last_chance`: the oldest later keyframe is about to leave the queue, and a strong loop of it
/// may come alone, where nothing contradicts it.
///
/// A loop may contradict the graph's covariances, as far as drift explains it (drift_explains())
/// and no refuted loop has claimed the same. Such loops are accepted in bundles of their own, where
/// nothing that the graph bears out contradicts them, nor another such bundle. So are those that
/// tie parts of the graph, as far as the gaps between the parts allow it; later keyframes of such a
/// bundle lie `least_apart`, or have turned by `least_turned`: who stands in one corridor has seen
/// nothing that a corridor like it would not have shown. Where the graph does not know how two
/// keyframes are turned to each other (a track that was lost in a turn, and no IMU), it bears out
/// whatever is found, and a corridor walked back looks like the same one walked on: such loops are
/// accepted where their later keyframes do not lie on one line.
std::vector<LoopVote> vote(const PoseGraph& graph, std::span<const LoopHypothesis> hypotheses,
                           const EarlierLoops& before, bool last_chance,
                           const LoopVotingSettings& settings);

/// Chi squared of the cycle of two loops over the graph: a's measurement, the way to b's later
/// keyframe, b's measurement back, and the way between the earlier ones. Infinite where the graph
/// does not tie them.
double disagreement(const PoseGraph& graph, const LoopHypothesis& a, const LoopHypothesis& b);

/// What a loop shows of the odometry's drift; nothing where the graph does not tie its keyframes.
std::optional<DriftDifference> shown_drift(const PoseGraph& graph, const LoopHypothesis& loop,
                                           const LoopVotingSettings& settings);

/// Chi squared of a loop against the graph's own relative pose.
double odometry_disagreement(const PoseGraph& graph, const LoopHypothesis& loop);

}  // namespace adit
