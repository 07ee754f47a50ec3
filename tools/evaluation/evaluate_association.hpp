// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "adit/tools/results/trajectory_io.hpp"

namespace adit {

/// Pose `estimate` of one trajectory and pose `truth` of the other show the same moment.
struct MatchedPair {
  std::size_t estimate = 0;
  std::size_t truth = 0;
};

/// How the stamps of a trajectory follow each other.
struct StampQuality {
  std::size_t repeated = 0;     ///< poses with the stamp of the pose before
  std::size_t conflicting = 0;  ///< of these, those with another pose than the one before
  double farthest = 0.0;        ///< m, between two poses of one stamp
  Nanoseconds step{0};  ///< greatest power of ten (ns) that divides all stamps: one unit of the
                        ///< last digit that was written
};
StampQuality stamp_quality(const Trajectory& trajectory);

/// How the pairs were found and what they cover.
struct AssociationSummary {
  bool by_time = false;  ///< else by index
  std::size_t pairs = 0;
  std::size_t estimate_poses = 0;   ///< in the file
  std::size_t truth_poses = 0;      ///< in the file
  double largest_difference = 0.0;  ///< s, of the stamps of a pair; 0 by index
  double covered_path = 0.0;        ///< m of the truth between its first and last matched pose
  double truth_path = 0.0;          ///< m, all of the truth
  std::size_t shared_truth = 0;     ///< pairs whose pose of the truth an earlier pair has, too
  std::size_t shared_estimate = 0;  ///< pairs whose pose of the estimate an earlier pair has, too
  StampQuality estimate_stamps{};   ///< of stamped trajectories
  StampQuality truth_stamps{};
};

struct Association {
  std::vector<MatchedPair> pairs;
  AssociationSummary summary;
};

/// Finds the pairs. By time if both trajectories are stamped: for each pose of the one with fewer
/// poses (the estimate where equal) the pose of the other that is nearest in time, if not farther
/// than `tolerance` seconds (evo's rule; a pose of the longer one may serve twice). All poses of
/// the estimate that have the stamp of a matched one are matched, too: each of them is a claim.
/// Else by index, as far as both go. Throws InputError where no pair is found, or where the stamps
/// of one trajectory were written with so few digits that most of its poses have no time of their
/// own.
Association associate(const Trajectory& estimate, const Trajectory& truth, double tolerance);

}  // namespace adit
