// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/initialization.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <queue>
#include <utility>

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

namespace adit {
namespace {

constexpr double kNoInformation = 1e-12;
using Triplets = std::vector<Eigen::Triplet<double>>;

/// Mean information of an edge about its rotation (1/rad^2); of a planar graph, about yaw.
double rotation_weight(const PoseEdge& edge, bool planar) {
  const double information =
      planar ? edge.information(5, 5) : edge.information.bottomRightCorner<3, 3>().trace() / 3.0;
  return std::max(information, kNoInformation);
}

double position_weight(const PoseEdge& edge, bool planar) {
  const double information = planar ? edge.information.topLeftCorner<2, 2>().trace() / 2.0
                                    : edge.information.topLeftCorner<3, 3>().trace() / 3.0;
  return std::max(information, kNoInformation);
}

/// Nodes that stay where they are: fixed ones, and the first of a component without any.
std::vector<bool> held_nodes(const PoseGraph& graph) {
  std::vector<bool> held(graph.nodes().size());
  for (std::size_t i = 0; i < held.size(); ++i) {
    held[i] = graph.nodes()[i].fixed;
  }
  for (const NodeId id : nodes_to_hold(connected_components(graph))) {
    held[graph.index_of(id)] = true;
  }
  return held;
}

/// Unknowns of the nodes that are not held, numbered in the order of nodes.
struct Unknowns {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> of_node;
  std::size_t count = 0;

  explicit Unknowns(const std::vector<bool>& held) : of_node(held.size(), kNone) {
    for (std::size_t i = 0; i < held.size(); ++i) {
      if (!held[i]) {
        of_node[i] = count++;
      }
    }
  }
};

using Solution = Eigen::Matrix<double, Eigen::Dynamic, 3>;

std::optional<Solution> solved(std::size_t size, const Triplets& lower, const Solution& right) {
  const auto n = static_cast<Eigen::Index>(size);
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(lower.begin(), lower.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
  if (factor.info() != Eigen::Success) {
    return std::nullopt;
  }
  Solution solution = factor.solve(right);
  return solution.allFinite() ? std::optional(std::move(solution)) : std::nullopt;
}

void add_block(Triplets& lower, std::size_t row, std::size_t column, const Eigen::Matrix3d& block) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const auto r = static_cast<int>(3 * row) + i;
      const auto c = static_cast<int>(3 * column) + j;
      if (r >= c) {
        lower.emplace_back(r, c, block(i, j));
      }
    }
  }
}

/// R_j^T = R_ij^T R_i^T: each node's unknown is its transposed rotation, three rows of three right
/// hand sides.
bool relax_rotations(const PoseGraph& graph, const Unknowns& unknowns,
                     std::vector<Eigen::Isometry3d>& poses) {
  Triplets lower;
  Solution right = Solution::Zero(static_cast<Eigen::Index>(3 * unknowns.count), 3);
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.status != EdgeStatus::active) {
      continue;
    }
    const double weight = rotation_weight(edge, graph.planar());
    const std::size_t from = graph.index_of(edge.from);
    const std::size_t to = graph.index_of(edge.to);
    const std::size_t i = unknowns.of_node[from];
    const std::size_t j = unknowns.of_node[to];
    const Eigen::Matrix3d r = edge.T_from_to.linear();
    if (i != Unknowns::kNone) {
      add_block(lower, i, i, weight * Eigen::Matrix3d::Identity());
    }
    if (j != Unknowns::kNone) {
      add_block(lower, j, j, weight * Eigen::Matrix3d::Identity());
    }
    if (i != Unknowns::kNone && j != Unknowns::kNone) {
      // The normal matrix holds -weight R_ij at (i, j); only its lower half is kept.
      if (i > j) {
        add_block(lower, i, j, -weight * r);
      } else {
        add_block(lower, j, i, -weight * r.transpose());
      }
    } else if (i != Unknowns::kNone) {
      right.middleRows<3>(static_cast<Eigen::Index>(3 * i)) +=
          weight * r * poses[to].linear().transpose();
    } else if (j != Unknowns::kNone) {
      right.middleRows<3>(static_cast<Eigen::Index>(3 * j)) +=
          weight * r.transpose() * poses[from].linear().transpose();
    }
  }
  const std::optional<Solution> solution = solved(3 * unknowns.count, lower, right);
  if (!solution) {
    return false;
  }
  for (std::size_t node = 0; node < poses.size(); ++node) {
    if (unknowns.of_node[node] != Unknowns::kNone) {
      const auto row = static_cast<Eigen::Index>(3 * unknowns.of_node[node]);
      Eigen::Isometry3d relaxed = Eigen::Isometry3d::Identity();
      relaxed.linear() = solution->middleRows<3>(row).transpose();
      poses[node].linear() = orthonormalized(relaxed).linear();
    }
  }
  return true;
}

/// t_j - t_i = R_i t_ij, with the rotations as they are.
bool relax_positions(const PoseGraph& graph, const Unknowns& unknowns,
                     std::vector<Eigen::Isometry3d>& poses) {
  Triplets lower;
  Solution right = Solution::Zero(static_cast<Eigen::Index>(unknowns.count), 3);
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.status != EdgeStatus::active) {
      continue;
    }
    const double weight = position_weight(edge, graph.planar());
    const std::size_t from = graph.index_of(edge.from);
    const std::size_t to = graph.index_of(edge.to);
    const Eigen::Vector3d step = poses[from].linear() * edge.T_from_to.translation();
    const auto i = static_cast<Eigen::Index>(unknowns.of_node[from]);
    const auto j = static_cast<Eigen::Index>(unknowns.of_node[to]);
    const bool i_moves = unknowns.of_node[from] != Unknowns::kNone;
    const bool j_moves = unknowns.of_node[to] != Unknowns::kNone;
    if (i_moves) {
      lower.emplace_back(i, i, weight);
      right.row(i) -= weight * step.transpose();
      if (!j_moves) {
        right.row(i) += weight * poses[to].translation().transpose();
      }
    }
    if (j_moves) {
      lower.emplace_back(j, j, weight);
      right.row(j) += weight * step.transpose();
      if (!i_moves) {
        right.row(j) += weight * poses[from].translation().transpose();
      }
    }
    if (i_moves && j_moves) {
      lower.emplace_back(std::max(i, j), std::min(i, j), -weight);
    }
  }
  const std::optional<Solution> solution = solved(unknowns.count, lower, right);
  if (!solution) {
    return false;
  }
  for (std::size_t node = 0; node < poses.size(); ++node) {
    if (unknowns.of_node[node] != Unknowns::kNone) {
      poses[node].translation() =
          solution->row(static_cast<Eigen::Index>(unknowns.of_node[node])).transpose();
    }
  }
  return true;
}

}  // namespace

std::vector<Eigen::Isometry3d> spanning_tree_poses(const PoseGraph& graph) {
  const std::vector<bool> held = held_nodes(graph);
  std::vector<Eigen::Isometry3d> poses = poses_of(graph);
  std::vector<double> variance(poses.size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (held[i]) {
      variance[i] = 0.0;
      open.emplace(0.0, i);
    }
  }
  while (!open.empty()) {
    const auto [reached, node] = open.top();
    open.pop();
    if (reached > variance[node]) {
      continue;
    }
    const NodeId id = graph.nodes()[node].id;
    for (const std::size_t i : graph.edges_of(id)) {
      const PoseEdge& edge = graph.edges()[i];
      const bool forward = edge.from == id;
      const std::size_t next = graph.index_of(forward ? edge.to : edge.from);
      const double through = reached + 1.0 / rotation_weight(edge, graph.planar());
      if (edge.status == EdgeStatus::active && through < variance[next]) {
        variance[next] = through;
        poses[next] = poses[node] * (forward ? edge.T_from_to : edge.T_from_to.inverse());
        open.emplace(through, next);
      }
    }
  }
  return poses;
}

std::vector<Eigen::Isometry3d> chordal_poses(const PoseGraph& graph) {
  const Unknowns unknowns(held_nodes(graph));
  std::vector<Eigen::Isometry3d> poses = poses_of(graph);
  if (unknowns.count == 0 ||
      (relax_rotations(graph, unknowns, poses) && relax_positions(graph, unknowns, poses))) {
    return poses;
  }
  return spanning_tree_poses(graph);
}

}  // namespace adit
