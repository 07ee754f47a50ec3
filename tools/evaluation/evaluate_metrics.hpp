// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Error measures of matched trajectories: absolute (ATE), relative (RPE, Sturm et al. 2012), and
// the segment errors of the KITTI odometry benchmark (Geiger et al. 2012).
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace adit {

/// Statistics of a list of errors, in its unit (sse: squared). All zero where count is 0.
struct Statistics {
  std::size_t count = 0;
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double std = 0.0;  ///< the population's
  double min = 0.0;
  double max = 0.0;
  double sse = 0.0;  ///< sum of squares
};
Statistics statistics(std::span<const double> errors);

using Poses = std::span<const Eigen::Isometry3d>;

/// Path length from the first pose to each, m.
std::vector<double> path_lengths(Poses poses);

/// Distances between positions, m.
std::vector<double> position_errors(Poses estimate, Poses truth);

/// Angles between attitudes, deg.
std::vector<double> rotation_errors(Poses estimate, Poses truth);

enum class DeltaUnit { frames, metres };
enum class PairSource { estimate, truth };

/// Which pairs of poses the relative errors compare: consecutive ones, each the given delta after
/// the one before, the delta in metres being travelled along the path of `pairs_from`.
struct RpeOptions {
  double delta = 10.0;  ///< m, or a whole number of frames
  DeltaUnit unit = DeltaUnit::metres;
  PairSource pairs_from = PairSource::estimate;  ///< whose path measures a delta in metres
  /// Metres only. false: the first pair starts where the first delta of the path ends, as in evo up
  /// to 1.36; true: at the first pose, as in evo from 1.37 on.
  bool from_first_pose = false;
};

using IndexPair = std::pair<std::size_t, std::size_t>;

/// Consecutive pairs `delta` frames apart; delta >= 1.
std::vector<IndexPair> pairs_by_frames(std::size_t poses, std::size_t delta);

/// Consecutive pairs at least `delta` metres of path apart; delta > 0.
std::vector<IndexPair> pairs_by_distance(Poses poses, double delta, bool from_first_pose);

struct RelativeErrors {
  Statistics translation;  ///< m
  Statistics rotation;     ///< deg
};

/// Errors E = (Q_i^-1 Q_j)^-1 (P_i^-1 P_j) of the motion between the poses of each pair.
RelativeErrors relative_errors(Poses estimate, Poses truth, const RpeOptions& options);

/// Mean errors over the segments of one length; `length` 0 stands for all lengths.
struct SegmentErrors {
  double length = 0.0;  ///< m
  std::size_t count = 0;
  double translation = 0.0;  ///< fraction of the length
  double rotation = 0.0;     ///< rad per m
};

/// Segments of 100, 200, ..., 800 m of the truth's path that start at every 10th pose; one entry
/// for each length that occurs, and at the end one for all (count 0 where the path is too short for
/// any).
std::vector<SegmentErrors> kitti_segment_errors(Poses estimate, Poses truth);

}  // namespace adit
