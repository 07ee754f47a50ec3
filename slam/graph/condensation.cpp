// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/condensation.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "adit/slam/graph/graph_residuals.hpp"

namespace adit {
namespace {

/// Tangent vectors of [rho, phi] from those of the convention: quaternions count half the angle.
Vector6d angle_units(ResidualConvention convention) {
  Vector6d scale = Vector6d::Ones();
  if (convention == ResidualConvention::quaternion) {
    scale.tail<3>().setConstant(2.0);
  }
  return scale;
}

/// The inverse over the directions that the graph has; zero elsewhere. None: not positive definite.
std::optional<Matrix6d> inverse(const Matrix6d& matrix, bool planar) {
  Matrix6d result = Matrix6d::Zero();
  if (planar) {
    const Eigen::LLT<Eigen::Matrix3d> factor(chosen_block<3>(matrix));
    if (factor.info() != Eigen::Success) {
      return std::nullopt;
    }
    const Eigen::Matrix3d block = factor.solve(Eigen::Matrix3d::Identity());
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        result(kPlanarRows[row], kPlanarRows[column]) = block(row, column);
      }
    }
    return result;
  }
  const Eigen::LLT<Matrix6d> factor(matrix);
  if (factor.info() != Eigen::Success) {
    return std::nullopt;
  }
  result = factor.solve(Matrix6d::Identity());
  return 0.5 * (result + result.transpose());
}

/// A relative pose with the covariance of its error, [rho, phi] on the right.
struct Motion {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();
};

Motion operator*(const Motion& first, const Motion& second) {
  const Matrix6d moved = adjoint(second.pose.inverse());
  return {first.pose * second.pose,
          moved * first.covariance * moved.transpose() + second.covariance};
}

class Condenser {
 public:
  Condenser(const PoseGraph& graph, ResidualConvention convention)
      : graph_(graph), units_(angle_units(convention)), inner_(inner_nodes()) {}

  /// The edge's motion away from a node.
  Motion motion(std::size_t index, NodeId from) const {
    const PoseEdge& edge = graph_.edges()[index];
    const Matrix6d covariance = *inverse(edge.information, graph_.planar());
    Motion motion{edge.T_from_to, units_.asDiagonal() * covariance * units_.asDiagonal()};
    if (edge.from != from) {
      const Matrix6d moved = adjoint(motion.pose);
      motion = {motion.pose.inverse(), moved * motion.covariance * moved.transpose()};
    }
    return motion;
  }

  /// Motions from the chain's first node to each of its nodes.
  std::vector<Motion> motions(const Chain& chain) const {
    std::vector<Motion> motions = {Motion{}};
    for (std::size_t i = 0; i < chain.edges.size(); ++i) {
      motions.push_back(motions.back() * motion(chain.edges[i], graph_.nodes()[chain.nodes[i]].id));
    }
    return motions;
  }

  std::vector<Chain> chains() {
    std::vector<Chain> chains;
    std::vector<bool> seen(graph_.edges().size());
    for (std::size_t start = 0; start < inner_.size(); ++start) {
      if (inner_[start]) {
        continue;
      }
      for (const std::size_t edge : graph_.edges_of(graph_.nodes()[start].id)) {
        if (!seen[edge] && inner_[other_end(edge, start)]) {
          Chain chain = walk(start, edge, seen);
          if (chain.nodes.front() == chain.nodes.back()) {
            split(chain, chains);
          } else {
            chains.push_back(std::move(chain));
          }
        }
      }
    }
    return chains;
  }

  CondensedGraph condensed() {
    CondensedGraph result{PoseGraph(graph_.planar()), chains()};
    std::vector<bool> inside(graph_.edges().size());
    for (const Chain& chain : result.chains) {
      for (const std::size_t edge : chain.edges) {
        inside[edge] = true;
      }
    }
    for (std::size_t i = 0; i < inner_.size(); ++i) {
      if (!inner_[i]) {
        result.graph.add_node(graph_.nodes()[i]);
      }
    }
    for (std::size_t i = 0; i < inside.size(); ++i) {
      const PoseEdge& edge = graph_.edges()[i];
      if (!inside[i] && edge.status == EdgeStatus::active) {
        result.graph.add_edge(edge);
      }
    }
    for (const Chain& chain : result.chains) {
      result.graph.add_edge(as_edge(chain));
    }
    for (const PositionFix& fix : graph_.fixes()) {
      result.graph.add_fix(fix);
    }
    for (const LevelledNode& level : graph_.levels()) {
      result.graph.add_level(level);
    }
    for (const MeasuredHeading& heading : graph_.headings()) {
      result.graph.add_heading(heading);
    }
    result.graph.set_T_world_map(graph_.T_world_map());
    return result;
  }

 private:
  std::vector<bool> inner_nodes() const {
    const std::vector<NodeId> held = nodes_to_hold(connected_components(graph_));
    std::vector<bool> in_world(graph_.nodes().size());
    for (const PositionFix& fix : graph_.fixes()) {
      in_world[graph_.index_of(fix.node)] = true;
    }
    for (const LevelledNode& level : graph_.levels()) {
      in_world[graph_.index_of(level.node)] = true;
    }
    for (const MeasuredHeading& heading : graph_.headings()) {
      in_world[graph_.index_of(heading.node)] = true;
    }
    std::vector<bool> inner(graph_.nodes().size());
    for (std::size_t i = 0; i < inner.size(); ++i) {
      const PoseNode& node = graph_.nodes()[i];
      int active = 0;
      bool odometry = true;
      for (const std::size_t index : graph_.edges_of(node.id)) {
        const PoseEdge& edge = graph_.edges()[index];
        if (edge.status == EdgeStatus::active) {
          ++active;
          odometry = odometry && edge.kind == EdgeKind::odometry &&
                     inverse(edge.information, graph_.planar()).has_value();
        }
      }
      inner[i] = active == 2 && odometry && !node.fixed && !in_world[i] &&
                 !std::ranges::binary_search(held, node.id);
    }
    return inner;
  }

  std::size_t other_end(std::size_t index, std::size_t node) const {
    const PoseEdge& edge = graph_.edges()[index];
    return graph_.index_of(edge.from == graph_.nodes()[node].id ? edge.to : edge.from);
  }

  Chain walk(std::size_t start, std::size_t edge, std::vector<bool>& seen) const {
    Chain chain{{start}, {}};
    while (true) {
      seen[edge] = true;
      const std::size_t node = other_end(edge, chain.nodes.back());
      chain.edges.push_back(edge);
      chain.nodes.push_back(node);
      if (!inner_[node]) {
        return chain;
      }
      for (const std::size_t next : graph_.edges_of(graph_.nodes()[node].id)) {
        if (next != chain.edges.back() && graph_.edges()[next].status == EdgeStatus::active) {
          edge = next;
          break;
        }
      }
    }
  }

  /// A chain that returns to its start would be an edge from a node to itself: the node in its
  /// middle stays, and what has only two nodes then stays an edge.
  void split(const Chain& chain, std::vector<Chain>& chains) {
    const std::size_t middle = chain.edges.size() / 2;
    inner_[chain.nodes[middle]] = false;
    const auto part = [&](std::size_t begin, std::size_t end) {
      if (end - begin >= 2) {
        const auto at = [](const auto& list, std::size_t i) {
          return list.begin() + static_cast<std::ptrdiff_t>(i);
        };
        chains.push_back({{at(chain.nodes, begin), at(chain.nodes, end + 1)},
                          {at(chain.edges, begin), at(chain.edges, end)}});
      }
    };
    part(0, middle);
    part(middle, chain.edges.size());
  }

  PoseEdge as_edge(const Chain& chain) const {
    const Motion whole = motions(chain).back();
    const Vector6d back = units_.cwiseInverse();
    PoseEdge edge;
    edge.from = graph_.nodes()[chain.nodes.front()].id;
    edge.to = graph_.nodes()[chain.nodes.back()].id;
    edge.T_from_to = orthonormalized(whole.pose);
    edge.information =
        *inverse(back.asDiagonal() * whole.covariance * back.asDiagonal(), graph_.planar());
    return edge;
  }

  const PoseGraph& graph_;
  Vector6d units_;
  std::vector<bool> inner_;
};

}  // namespace

CondensedGraph condensed(const PoseGraph& graph, ResidualConvention convention) {
  return Condenser(graph, convention).condensed();
}

std::vector<Eigen::Isometry3d> expanded(const PoseGraph& graph, const CondensedGraph& condensed,
                                        const std::vector<Eigen::Isometry3d>& poses,
                                        ResidualConvention convention) {
  std::vector<Eigen::Isometry3d> result = poses_of(graph);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    result[graph.index_of(condensed.graph.nodes()[i].id)] = poses[i];
  }
  const Condenser condenser(graph, convention);
  for (const Chain& chain : condensed.chains) {
    const std::vector<Motion> motions = condenser.motions(chain);
    const Eigen::Isometry3d& first = result[chain.nodes.front()];
    const Motion& whole = motions.back();
    const Vector6d left = se3_log((first * whole.pose).inverse() * result[chain.nodes.back()]);
    const Vector6d force = *inverse(whole.covariance, graph.planar()) * left;
    for (std::size_t i = 1; i + 1 < motions.size(); ++i) {
      // The error of node i given that of the end: Cov(i, end) Cov(end)^-1.
      const Matrix6d to_end = adjoint(whole.pose.inverse() * motions[i].pose);
      result[chain.nodes[i]] = orthonormalized(
          first * motions[i].pose * se3_exp(motions[i].covariance * (to_end.transpose() * force)));
    }
  }
  return result;
}

OptimizedGraph optimize_condensed(const PoseGraph& graph, const OptimizationSettings& settings,
                                  std::size_t beyond) {
  if (graph.nodes().size() <= beyond) {
    return optimize(graph, settings);
  }
  const auto start = std::chrono::steady_clock::now();
  const CondensedGraph small = condensed(graph, settings.convention);
  if (2 * small.graph.nodes().size() > graph.nodes().size()) {
    return optimize(graph, settings);
  }
  const OptimizedGraph ends = optimize(small.graph, settings);
  if (ends.report.termination == Termination::stopped) {
    OptimizedGraph stopped{expanded(graph, small, ends.poses, settings.convention),
                           ends.T_world_map, ends.report};
    stopped.report.edges = edge_results(graph, stopped.poses, settings);
    return stopped;
  }
  PoseGraph whole = graph;
  whole.set_poses(expanded(graph, small, ends.poses, settings.convention));
  whole.set_T_world_map(ends.T_world_map);
  OptimizedGraph result = optimize(whole, settings);
  result.report.cost_before = graph_cost(graph, settings);
  result.report.iterations += ends.report.iterations;
  result.report.restarted |= ends.report.restarted;
  result.report.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace adit
