// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The optimisation of a map's graph with its loops (docs/theory/loops.md).
#pragma once

#include <functional>

#include "adit/slam/graph/solver.hpp"

namespace adit {

/// Loops whose residual is beyond this (chi squared of 6 directions: 99.9 %) after an optimisation
/// are taken back.
inline constexpr double kLoopReview = 22.5;

/// The kernels of optimize_with_loops(): against the odometry's few large errors and wrong loops.
OptimizationSettings loop_kernels();

/// Where a map lies that only its verticals tie to the world (no fixes): turned the shortest way to
/// where its nodes, as they are, meet their verticals best; without verticals as it is. A map does
/// not keep it, and its cost is a cost of the poses alone with it.
Eigen::Isometry3d levelled_world(const PoseGraph& graph);

/// With what these leave of each edge where the graph is.
PoseGraph as_weighted(const PoseGraph& graph);

struct LoopOptimum : OptimizedGraph {
  /// The odometry's covariances counted so many times, 1 or more; chi squared and cost of its edges
  /// are with those.
  double odometry_scale = 1.0;
  double level_drift_scale =
      1.0;                 ///< and its level drift's so many times, by fixes (HorizontalDrift)
  bool all_drift = false;  ///< the odometry's edges count squared, since all of them are off
};

/// The minimum of a map's graph with its loops under a kernel that takes all influence from wrong
/// ones.
///
/// Where the loops that fit show that the odometry's edges as a whole are off by more than their
/// covariances say, these are scaled until the median edge between the ends of loops is as far off
/// as it says (an estimate of the variance component). Few edges that are far off do not change
/// that: they take what the loops correct. Where most of three or more do not fit, all of them say
/// it, if most fit then: the kernel takes all influence from many right ones sooner than it bends
/// the odometry by many of its standard deviations.
///
/// Where all edges drift, no few of them stand out, and the kernel that forgives a few would have
/// these carry all of it. So where an edge had to jump by more than 0.5 m or 0.05 rad and more than
/// it says (kLoopReview), they count squared, if none jumps then and the
/// loops fit as well.
///
/// Where there are fixes, these and the loops tell how far the odometry drifts in the level
/// (horizontal_drift()), unless a loop that fits would not fit then.
///
/// `on_step` is asked after each iteration; false ends the work (Termination::stopped).
LoopOptimum optimize_with_loops(const PoseGraph& graph,
                                const std::function<bool(const OptimizationStep&)>& on_step = {});

}  // namespace adit
