// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/loop_optimization.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>

#include "adit/slam/core/median.hpp"
#include "adit/slam/graph/condensation.hpp"
#include "adit/slam/graph/graph_residuals.hpp"
#include "adit/slam/graph/horizontal_drift.hpp"
#include "adit/slam/graph/implied_drift.hpp"

namespace adit {
namespace {

// Few edges of the odometry are off by many of their standard deviations: beyond one, errors count
// as they are and not squared, so that those few take what the loops correct
// (docs/theory/loops.md).
constexpr RobustLoss kOdometryKernel{.kernel = Kernel::pseudo_huber, .width = 1.0};
// Median of chi squared with 6 directions.
constexpr double kMedianChi2 = 5.348;
// The scale is settled once a round leaves it within this factor; each round comes much nearer.
constexpr double kSettled = 1.1;
constexpr int kMostRounds = 8;
// Against the odometry: as many as a bundle has.
constexpr std::size_t kFewestBelieved = 3;
// No single step of an odometry that keeps its track is wrong by as much.
constexpr double kJump = 0.5;       // m
constexpr double kJumpTurn = 0.05;  // rad

/// Chi squared of the median odometry edge between the ends of loops; 0 where there is none.
double median_chi2(const PoseGraph& graph, const OptimizationReport& report) {
  const std::vector<bool> in_a_loop = within_loops(graph);
  std::vector<double> chi2;
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    const PoseEdge& edge = graph.edges()[i];
    const std::size_t first = std::min(graph.index_of(edge.from), graph.index_of(edge.to));
    if (edge.kind == EdgeKind::odometry && report.edges[i] && in_a_loop[first]) {
      chi2.push_back(report.edges[i]->chi2);
    }
  }
  return chi2.empty() ? 0.0 : median(std::move(chi2));
}

using OnStep = std::function<bool(const OptimizationStep&)>;

bool is_loop_that_does_not_fit(const PoseGraph& graph, const OptimizedGraph& optimum,
                               std::size_t i) {
  const std::optional<EdgeResult>& result = optimum.report.edges[i];
  return graph.edges()[i].kind == EdgeKind::loop && result && result->chi2 > kLoopReview;
}

/// With the poses of an optimum, and without the loops that it does not fit.
PoseGraph fitting_part(PoseGraph graph, const OptimizedGraph& optimum) {
  graph.set_poses(optimum.poses);
  graph.set_T_world_map(optimum.T_world_map);
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    if (is_loop_that_does_not_fit(graph, optimum, i)) {
      graph.set_status(i, EdgeStatus::revoked);
    }
  }
  return graph;
}

/// Fewer than a bundle are not believed against the odometry.
bool most_loops_fit(const PoseGraph& graph, const OptimizedGraph& optimum) {
  std::size_t loops = 0;
  std::size_t others = 0;
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    const bool counts = graph.edges()[i].kind == EdgeKind::loop && optimum.report.edges[i];
    loops += counts ? 1U : 0U;
    others += is_loop_that_does_not_fit(graph, optimum, i) ? 1U : 0U;
  }
  return loops < kFewestBelieved || 2 * others <= loops;
}

/// Every loop that fitted the other optimum fits this one.
bool fits_as_well(const PoseGraph& graph, const OptimizedGraph& optimum,
                  const OptimizedGraph& other) {
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    if (is_loop_that_does_not_fit(graph, optimum, i) &&
        !is_loop_that_does_not_fit(graph, other, i)) {
      return false;
    }
  }
  return true;
}

// A scale that is too small leaves part of the drift to the loops, so that edges seem better than
// they are: hence the rounds.
double odometry_scale(const PoseGraph& graph, const OnStep& on_step) {
  const OptimizationSettings squared{.convention = ResidualConvention::rotation,
                                     .on_step = on_step};
  double scale = 1.0;
  for (int round = 0; round < kMostRounds; ++round) {
    const PoseGraph trial = graph.with_odometry_scaled(scale);
    const OptimizationReport report = optimize_condensed(trial, squared).report;
    if (report.termination == Termination::failed) {
      break;
    }
    const double found = scale * median_chi2(trial, report) / kMedianChi2;
    const bool settled = found < kSettled * scale;
    scale = std::max(scale, found);
    if (settled) {
      break;
    }
  }
  return scale;
}

/// An edge of the odometry is off by more than a step can be, and than it says.
bool has_jump(const PoseGraph& graph, const OptimizedGraph& optimum) {
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    const PoseEdge& edge = graph.edges()[i];
    const std::optional<EdgeResult>& result = optimum.report.edges[i];
    if (edge.kind != EdgeKind::odometry || !result || result->chi2 <= kLoopReview) {
      continue;
    }
    const Eigen::Isometry3d way =
        optimum.poses[graph.index_of(edge.from)].inverse() * optimum.poses[graph.index_of(edge.to)];
    const Eigen::Isometry3d error = way * edge.T_from_to.inverse();
    if (error.translation().norm() > kJump || rotation_angle(error.linear()) > kJumpTurn) {
      return true;
    }
  }
  return false;
}

/// A node that knows its vertical leans by more than an odometry with an inertial sensor may.
bool leans(const PoseGraph& graph, const OptimizedGraph& optimum) {
  return std::ranges::any_of(graph.levels(), [&](const LevelledNode& level) {
    return is_tilted(optimum.T_world_map * optimum.poses[graph.index_of(level.node)]);
  });
}

// Of all loops under a kernel that takes all influence from wrong ones, looked for from where all
// are accepted: from far off, where much drift is to be corrected, the kernel would take it from
// right ones, too.
OptimizedGraph robust_optimum(PoseGraph graph, bool all_drift, const OnStep& on_step) {
  OptimizationSettings settings = loop_kernels();
  settings.on_step = on_step;
  if (all_drift) {
    settings.odometry_kernel = {};
  }
  const RobustLoss against_wrong_ones = std::exchange(settings.loop_kernel, {});
  const OptimizedGraph all_believed = optimize_condensed(graph, settings);
  settings.loop_kernel = against_wrong_ones;
  const double cost_before = graph_cost(graph, settings);
  if (all_believed.report.termination != Termination::failed) {
    graph.set_poses(all_believed.poses);
    graph.set_T_world_map(all_believed.T_world_map);
  }
  OptimizedGraph optimum = optimize_condensed(graph, settings);
  optimum.report.cost_before = cost_before;
  optimum.report.iterations += all_believed.report.iterations;
  return optimum;
}

LoopOptimum at_scale(const PoseGraph& graph, double scale, bool all_drift, const OnStep& on_step) {
  LoopOptimum optimum{
      robust_optimum(scale > 1.0 ? graph.with_odometry_scaled(scale) : graph, all_drift, on_step)};
  optimum.odometry_scale = scale;
  optimum.all_drift = all_drift;
  return optimum;
}

bool has_ended_well(const OptimizationReport& report) {
  return report.termination != Termination::failed && report.termination != Termination::stopped;
}

// The scale is one that the loops which fit have shown with drift left to them: some may need more.
// So may verticals, which bear what is left: a climb is cheaper where all of the way leans.
LoopOptimum shared_out(const PoseGraph& graph, LoopOptimum optimum, const OnStep& on_step) {
  if (optimum.odometry_scale == 1.0 || !has_ended_well(optimum.report) ||
      !(has_jump(graph, optimum) || leans(graph, optimum))) {
    return optimum;
  }
  std::optional<LoopOptimum> leaning;
  for (const double more : {1.0, 4.0, 16.0, 64.0, 256.0}) {
    LoopOptimum shared = at_scale(graph, more * optimum.odometry_scale, true, on_step);
    if (!has_ended_well(shared.report) || has_jump(graph, shared) ||
        !fits_as_well(graph, shared, optimum)) {
      continue;
    }
    if (!leans(graph, shared)) {
      return shared;
    }
    if (!leaning) {
      leaning = std::move(shared);
    }
  }
  return leaning ? std::move(*leaning) : std::move(optimum);
}

LoopOptimum of_loops(const PoseGraph& graph, const OnStep& on_step) {
  LoopOptimum optimum = at_scale(graph, 1.0, false, on_step);
  const bool fits = most_loops_fit(graph, optimum);
  const double scale = odometry_scale(fitting_part(graph, optimum), on_step);
  if (scale > 1.0) {
    optimum = shared_out(graph, at_scale(graph, scale, false, on_step), on_step);
  }
  if (!fits && !most_loops_fit(graph, optimum)) {
    LoopOptimum believed = at_scale(graph, odometry_scale(graph, on_step), false, on_step);
    if (most_loops_fit(graph, believed)) {
      return shared_out(graph, std::move(believed), on_step);
    }
  }
  return optimum;
}

}  // namespace

OptimizationSettings loop_kernels() {
  return {.convention = ResidualConvention::rotation,
          .odometry_kernel = kOdometryKernel,
          .loop_kernel = {.kernel = Kernel::dcs}};
}

// The sum of the squared sines between a direction of the map and the nodes' z axes is least along
// the eigenvector of the largest eigenvalue.
Eigen::Isometry3d levelled_world(const PoseGraph& graph) {
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const LevelledNode& level : graph.levels()) {
    const auto edges = graph.edges_of(level.node);
    const bool tied = std::ranges::any_of(
        edges, [&](std::size_t edge) { return graph.edges()[edge].status == EdgeStatus::active; });
    if (tied) {
      const Eigen::Vector3d z =
          graph.nodes()[graph.index_of(level.node)].T_map_node.linear().col(2);
      squares += level.information * z * z.transpose();
      sum += level.information * z;
    }
  }
  if (!graph.fixes().empty() || !(sum.norm() > 0.0)) {
    return graph.T_world_map();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(squares);
  const Eigen::Vector3d axis = eigen.eigenvectors().col(2);
  const Eigen::Vector3d up = axis.dot(sum) < 0.0 ? Eigen::Vector3d(-axis) : axis;
  Eigen::Isometry3d T_world_map = Eigen::Isometry3d::Identity();
  T_world_map.linear() =
      Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T_world_map;
}

PoseGraph as_weighted(const PoseGraph& graph) {
  const auto results = edge_results(graph, poses_of(graph), loop_kernels());
  std::size_t i = 0;
  return graph.with_information([&](const PoseEdge& edge) -> Matrix6d {
    const std::optional<EdgeResult>& result = results[i++];
    return result ? Matrix6d(result->weight * edge.information) : edge.information;
  });
}

LoopOptimum optimize_with_loops(const PoseGraph& graph, const OnStep& on_step) {
  LoopOptimum optimum = of_loops(graph, on_step);
  if (graph.fixes().empty() || !has_ended_well(optimum.report)) {
    return optimum;
  }
  PoseGraph placed = graph.with_odometry_scaled(optimum.odometry_scale);
  placed.set_poses(optimum.poses);
  placed.set_T_world_map(optimum.T_world_map);
  const double drift = horizontal_drift(placed).smallest;
  if (drift == 1.0) {
    return optimum;
  }
  PoseGraph scaled = with_horizontal_drift(placed, drift);
  LoopOptimum again{robust_optimum(scaled, optimum.all_drift, on_step)};
  if (again.report.termination == Termination::stopped) {
    optimum.report.termination = Termination::stopped;
  }
  if (again.report.termination != Termination::converged || !fits_as_well(graph, again, optimum)) {
    return optimum;
  }
  again.odometry_scale = optimum.odometry_scale;
  again.level_drift_scale = drift;
  again.all_drift = optimum.all_drift;
  scaled.set_poses(poses_of(graph));
  scaled.set_T_world_map(graph.T_world_map());
  again.report.cost_before = graph_cost(scaled, loop_kernels());
  return again;
}

}  // namespace adit
