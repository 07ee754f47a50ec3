// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/graph_residuals.hpp"

#include <numbers>

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

WhitenedTie<3> FixResidual::linearized(const Eigen::Isometry3d& T_world_map,
                                       const Eigen::Isometry3d& T_map_node) const {
  const Eigen::Vector3d p_map = T_map_node * p_node_;
  const Eigen::Matrix3d rows = root_ * T_world_map.linear();
  WhitenedTie<3> tie;
  tie.residual = root_ * (T_world_map * p_map - p_world_);
  tie.by_world << rows, -rows * skew(p_map);
  const Eigen::Matrix3d turned = rows * T_map_node.linear();
  tie.by_node << turned, -turned * skew(p_node_);
  return tie;
}

WhitenedTie<2> LevelResidual::linearized(const Eigen::Isometry3d& T_world_map,
                                         const Eigen::Isometry3d& T_map_node) const {
  const Eigen::Vector3d up_map = T_world_map.linear().transpose() * Eigen::Vector3d::UnitZ();
  const Eigen::Matrix3d R_node_map = T_map_node.linear().transpose();
  const Eigen::Vector3d up_node = R_node_map * up_map;
  WhitenedTie<2> tie;
  tie.residual = root_ * up_node.head<2>();
  tie.by_world.setZero();
  tie.by_node.setZero();
  tie.by_world.rightCols<3>() = root_ * (R_node_map * skew(up_map)).topRows<2>();
  tie.by_node.rightCols<3>() = root_ * skew(up_node).topRows<2>();
  return tie;
}

// A turn about the vertical turns the yaw by as much, whichever way the axis leans. By a tilt the
// yaw of an axis that leans changes, too; that is left out, so that no heading bends a tilt which
// nothing else holds.
WhitenedTie<1> HeadingResidual::linearized(const Eigen::Isometry3d& T_world_map,
                                           const Eigen::Isometry3d& T_map_node) const {
  constexpr double kUpright = 1e-6;  // squared cosine of the axis's elevation
  const Eigen::Vector3d axis_world = T_world_map.linear() * (T_map_node.linear() * axis_node_);
  WhitenedTie<1> tie;
  tie.residual.setZero();
  tie.by_world.setZero();
  tie.by_node.setZero();
  if (axis_world.head<2>().squaredNorm() < kUpright) {
    return tie;
  }
  tie.residual(0) = root_ * std::remainder(std::atan2(axis_world.y(), axis_world.x()) - yaw_,
                                           2.0 * std::numbers::pi);
  const Eigen::RowVector3d vertical_map = T_world_map.linear().row(2);
  tie.by_world.rightCols<3>() = root_ * vertical_map;
  tie.by_node.rightCols<3>() = root_ * vertical_map * T_map_node.linear();
  return tie;
}

double cost_of(const PoseGraph& graph, const OptimizedGraph& optimized,
               const OptimizationSettings& settings) {
  double cost = 0.0;
  const std::vector<std::optional<EdgeResult>>& edges = optimized.report.edges;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (edges[i]) {
      cost += apply(kernel_of(graph.edges()[i], settings), edges[i]->chi2).cost;
    }
  }
  const auto add = [&](NodeId node, const auto& residual) {
    cost += residual.linearized(optimized.T_world_map, optimized.poses[graph.index_of(node)])
                .residual.squaredNorm();
  };
  for (const PositionFix& fix : graph.fixes()) {
    add(fix.node, FixResidual(fix));
  }
  for (const LevelledNode& level : graph.levels()) {
    add(level.node, LevelResidual(level));
  }
  for (const MeasuredHeading& heading : graph.headings()) {
    add(heading.node, HeadingResidual(heading));
  }
  return cost;
}

double graph_cost(const PoseGraph& graph, const OptimizationSettings& settings) {
  OptimizedGraph as_it_is{
      .poses = poses_of(graph), .T_world_map = graph.T_world_map(), .report = {}};
  as_it_is.report.edges = edge_results(graph, as_it_is.poses, settings);
  return cost_of(graph, as_it_is, settings);
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
