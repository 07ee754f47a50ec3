// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/graph_residuals.hpp"

namespace adit {
namespace {

const RobustLoss& kernel_of(const PoseEdge& edge, const OptimizationSettings& settings) {
  return edge.kind == EdgeKind::loop ? settings.loop_kernel : settings.odometry_kernel;
}

template <int kFreedom>
double chi2(const PoseEdge& edge, const Eigen::Isometry3d& first, const Eigen::Isometry3d& second,
            ResidualConvention convention) {
  return EdgeResidual<kFreedom>(edge, convention)
      .linearized(first, second, false)
      .residual.squaredNorm();
}

}  // namespace

std::vector<std::optional<EdgeResult>> edge_results(const PoseGraph& graph,
                                                    std::span<const Eigen::Isometry3d> poses,
                                                    const OptimizationSettings& settings) {
  std::vector<std::optional<EdgeResult>> results(graph.edges().size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    const PoseEdge& edge = graph.edges()[i];
    if (edge.status != EdgeStatus::active) {
      continue;
    }
    const Eigen::Isometry3d& first = poses[graph.index_of(edge.from)];
    const Eigen::Isometry3d& second = poses[graph.index_of(edge.to)];
    const double value = graph.planar() ? chi2<3>(edge, first, second, settings.convention)
                                        : chi2<6>(edge, first, second, settings.convention);
    results[i] = EdgeResult{value, apply(kernel_of(edge, settings), value).weight};
  }
  return results;
}

double cost_of(const PoseGraph& graph, std::span<const std::optional<EdgeResult>> edges,
               const OptimizationSettings& settings) {
  double cost = 0.0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (edges[i]) {
      cost += apply(kernel_of(graph.edges()[i], settings), edges[i]->chi2).cost;
    }
  }
  return cost;
}

double graph_cost(const PoseGraph& graph, const OptimizationSettings& settings) {
  return cost_of(graph, edge_results(graph, poses_of(graph), settings), settings);
}

std::string_view to_string(Termination termination) {
  switch (termination) {
    case Termination::converged:
      return "converged";
    case Termination::nothing_to_do:
      return "nothing to do";
    case Termination::iteration_limit:
      return "iteration limit";
    case Termination::stopped:
      return "stopped";
    default:
      return "failed";
  }
}

}  // namespace adit
