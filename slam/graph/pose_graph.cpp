// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/pose_graph.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace adit {
namespace {

// Rounding of files and of sums leaves informations that are slightly asymmetric or indefinite;
// relative to the largest entry.
constexpr double kRounding = 1e-9;

std::string name(const PoseEdge& edge) {
  return "the edge from " + std::to_string(edge.from) + " to " + std::to_string(edge.to);
}

bool is_planar(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d& r = pose.linear();
  return std::abs(pose.translation().z()) < kRounding && std::abs(r(2, 2) - 1.0) < kRounding;
}

bool is_rotation(const Eigen::Matrix3d& r) {
  return (r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-6 &&
         r.determinant() > 0.0;
}

void require_pose(const Eigen::Isometry3d& pose, bool planar, const std::string& owner) {
  if (!pose.matrix().allFinite()) {
    throw GraphError("the pose of " + owner + " is not finite");
  }
  if (!is_rotation(pose.linear())) {
    throw GraphError("the pose of " + owner + " holds no rotation");
  }
  if (planar && !is_planar(pose)) {
    throw GraphError("the pose of " + owner + " is not in the plane, and the graph is planar");
  }
}

template <class Matrix>
void require_information(const Matrix& information, const std::string& owner) {
  if (!information.allFinite()) {
    throw GraphError("the information of " + owner + " is not finite");
  }
  const double largest = information.cwiseAbs().maxCoeff();
  if ((information - information.transpose()).cwiseAbs().maxCoeff() > kRounding * largest) {
    throw GraphError("the information of " + owner + " is not symmetric");
  }
  if (Eigen::LLT<Matrix>(information).info() == Eigen::Success) {
    return;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(information, Eigen::EigenvaluesOnly);
  if (eigen.eigenvalues()(0) < -kRounding * largest) {
    throw GraphError("the information of " + owner + " has a negative eigenvalue (" +
                     std::to_string(eigen.eigenvalues()(0)) + ")");
  }
}

/// Disjoint sets of indices, each known by its smallest.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }

  std::size_t find(std::size_t i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }

  void join(std::size_t a, std::size_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace

void PoseGraph::add_node(const PoseNode& node) {
  require_pose(node.T_map_node, planar_, "node " + std::to_string(node.id));
  if (nodes_.empty() || nodes_.back().id < node.id) {
    nodes_.push_back(node);
    edges_of_.emplace_back();
    return;
  }
  const auto at = std::ranges::lower_bound(nodes_, node.id, {}, &PoseNode::id);
  if (at->id == node.id) {
    throw GraphError("node " + std::to_string(node.id) + " is there already");
  }
  edges_of_.insert(edges_of_.begin() + (at - nodes_.begin()), std::vector<std::size_t>());
  nodes_.insert(at, node);
}

void PoseGraph::add_edge(const PoseEdge& edge) {
  for (const NodeId id : {edge.from, edge.to}) {
    if (!contains(id)) {
      throw GraphError(name(edge) + " names node " + std::to_string(id) + ", which does not exist");
    }
  }
  if (edge.from == edge.to) {
    throw GraphError(name(edge) + " ties a node to itself");
  }
  require_pose(edge.T_from_to, planar_, name(edge));
  require_information(edge.information, name(edge));
  for (const NodeId id : {edge.from, edge.to}) {
    edges_of_[index_of(id)].push_back(edges_.size());
  }
  edges_.push_back(edge);
}

void PoseGraph::add_fix(const PositionFix& fix) {
  const std::string name = "a fix of node " + std::to_string(fix.node);
  require_in_space(fix.node, name);
  if (!fix.p_node.allFinite() || !fix.p_world.allFinite()) {
    throw GraphError(name + " is not finite");
  }
  require_information(fix.information, name);
  fixes_.push_back(fix);
}

void PoseGraph::add_level(const LevelledNode& level) {
  const std::string name = "the level of node " + std::to_string(level.node);
  require_in_space(level.node, name);
  if (!std::isfinite(level.information) || level.information < 0.0) {
    throw GraphError("the information of " + name + " is none");
  }
  levels_.push_back(level);
}

void PoseGraph::add_heading(const MeasuredHeading& heading) {
  constexpr double kUnitLength = 1e-6;
  const std::string name = "the heading of node " + std::to_string(heading.node);
  require_in_space(heading.node, name);
  if (!std::isfinite(heading.yaw) || !(std::abs(heading.axis_node.norm() - 1.0) < kUnitLength)) {
    throw GraphError(name + " is not finite, or its axis is not of length 1");
  }
  if (!std::isfinite(heading.information) || heading.information < 0.0) {
    throw GraphError("the information of " + name + " is none");
  }
  headings_.push_back(heading);
}

void PoseGraph::require_in_space(NodeId id, const std::string& name) const {
  if (planar_) {
    throw GraphError(name + " has no place in a planar graph");
  }
  if (!contains(id)) {
    throw GraphError(name + " has no node: there is no node " + std::to_string(id));
  }
}

void PoseGraph::set_poses(std::span<const Eigen::Isometry3d> poses) {
  if (poses.size() != nodes_.size()) {
    throw GraphError("poses given: " + std::to_string(poses.size()) +
                     ", nodes in the graph: " + std::to_string(nodes_.size()));
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    nodes_[i].T_map_node = poses[i];
  }
}

PoseGraph PoseGraph::with_odometry_scaled(double scale) const {
  return with_information([scale](const PoseEdge& edge) -> Matrix6d {
    return edge.kind == EdgeKind::odometry ? Matrix6d(edge.information / scale) : edge.information;
  });
}

bool PoseGraph::contains(NodeId id) const {
  const auto at = std::ranges::lower_bound(nodes_, id, {}, &PoseNode::id);
  return at != nodes_.end() && at->id == id;
}

std::size_t PoseGraph::index_of(NodeId id) const {
  if (const auto counted = static_cast<std::size_t>(id);
      counted < nodes_.size() && nodes_[counted].id == id) {
    return counted;  // as in every map of one session
  }
  const auto at = std::ranges::lower_bound(nodes_, id, {}, &PoseNode::id);
  if (at == nodes_.end() || at->id != id) {
    throw GraphError("there is no node " + std::to_string(id));
  }
  return static_cast<std::size_t>(at - nodes_.begin());
}

GraphComponents connected_components(const PoseGraph& graph) {
  const std::vector<PoseNode>& nodes = graph.nodes();
  DisjointSets sets(nodes.size());
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.status == EdgeStatus::active) {
      sets.join(graph.index_of(edge.from), graph.index_of(edge.to));
    }
  }
  GraphComponents result;
  result.component_of.resize(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::size_t root = sets.find(i);  // never after i
    if (root == i) {
      result.component_of[i] = result.components.size();
      result.components.push_back({.first = nodes[i].id});
    } else {
      result.component_of[i] = result.component_of[root];
    }
    GraphComponent& component = result.components[result.component_of[i]];
    ++component.nodes;
    component.has_fixed_node |= nodes[i].fixed;
  }
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.status == EdgeStatus::active) {
      ++result.components[result.component_of[graph.index_of(edge.from)]].edges;
    }
  }
  return result;
}

std::vector<NodeId> nodes_to_hold(const GraphComponents& components) {
  std::vector<NodeId> held;
  for (const GraphComponent& component : components.components) {
    if (!component.has_fixed_node) {
      held.push_back(component.first);
    }
  }
  return held;
}

std::vector<Eigen::Isometry3d> poses_of(const PoseGraph& graph) {
  std::vector<Eigen::Isometry3d> poses;
  poses.reserve(graph.nodes().size());
  for (const PoseNode& node : graph.nodes()) {
    poses.push_back(node.T_map_node);
  }
  return poses;
}

bool expects_start(const PoseGraph& graph) {
  return std::ranges::any_of(graph.edges(), [](const PoseEdge& edge) {
    return edge.kind == EdgeKind::start && edge.status == EdgeStatus::active;
  });
}

}  // namespace adit
