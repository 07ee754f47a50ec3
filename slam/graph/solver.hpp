// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Least squares over a pose graph. solver.cpp is the one file that sees Ceres.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/slam/graph/between_factor.hpp"
#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

/// The optimisation after one of its iterations.
struct OptimizationStep {
  int iteration = 0;  ///< 0: the start
  double cost = 0.0;  ///< sum of chi squared under the kernels, not halved
};

/// How a graph is optimised.
struct OptimizationSettings {
  ResidualConvention convention =
      ResidualConvention::rotation;  ///< what an edge's information belongs to
  RobustLoss odometry_kernel{};      ///< of edges that the odometry made
  RobustLoss loop_kernel{};          ///< of loops
  int max_iterations = 100;          ///< at most
  /// Converged once an iteration changes the cost by less than this part of it.
  double cost_tolerance = 1e-10;
  /// Levenberg-Marquardt's first trust region. This one makes the first steps Gauss-Newton's, of
  /// which a pose graph needs a sixth as many; where two in a row raise the cost the optimisation
  /// starts again with `cautious_radius`.
  double initial_radius = 1e16;
  double cautious_radius = 1e4;  ///< of the second start
  /// Called after each iteration; false ends the optimisation.
  std::function<bool(const OptimizationStep&)> on_step{};
};

/// Why an optimisation ended.
enum class Termination {
  converged,
  nothing_to_do,    ///< no active edge touches a node that may move
  iteration_limit,  ///< max_iterations are reached
  stopped,          ///< by on_step
  failed,           ///< numerically; OptimizationReport::message says how
};
/// For people.
std::string_view to_string(Termination termination);

/// An active edge at the end of the optimisation.
struct EdgeResult {
  double chi2 = 0.0;    ///< without kernel
  double weight = 1.0;  ///< that the kernel leaves it
};

/// How an optimisation went.
struct OptimizationReport {
  Termination termination = Termination::nothing_to_do;  ///< why it ended
  std::string message;                                   ///< the solver's own words
  double cost_before = 0.0;  ///< sum of chi squared under the kernels, not halved
  double cost_after = 0.0;   ///< the same at the end
  int iterations = 0;        ///< that were done
  bool restarted = false;    ///< with the cautious radius
  double seconds = 0.0;      ///< it took
  /// One per edge, in the graph's order; nothing for those that are not active.
  std::vector<std::optional<EdgeResult>> edges;
  GraphComponents components;  ///< parts that nothing ties together
  std::vector<NodeId>
      held;  ///< nodes that stayed in place because nothing in their component is fixed
};

/// Poses in the order of the graph's nodes: the optimised ones, also where the iterations ended
/// early or failed (then the best so far).
struct OptimizedGraph {
  std::vector<Eigen::Isometry3d> poses;                           ///< of the nodes
  Eigen::Isometry3d T_world_map = Eigen::Isometry3d::Identity();  ///< of a graph tied to the world
  OptimizationReport report;                                      ///< how it went
};

/// Minimises the sum of the squared residuals of active edges, under their kernels, of fixes and of
/// levels. T_world_map is free where there are any of the latter two; of what they do not tell
/// it keeps the start's. Deterministic: the order in which nodes and edges were added does not
/// matter, and time decides nothing.
OptimizedGraph optimize(const PoseGraph& graph, const OptimizationSettings& settings);

/// The same sum where the graph's poses are.
double graph_cost(const PoseGraph& graph, const OptimizationSettings& settings);

}  // namespace adit
