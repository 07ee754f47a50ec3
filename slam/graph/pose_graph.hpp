// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Poses and what was measured between them, as plain values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "adit/slam/core/lie.hpp"

namespace adit {

/// Of a node, unique in a graph.
using NodeId = int64_t;

/// A pose that the optimisation may move.
struct PoseNode {
  NodeId id = 0;                                                 ///< unique in the graph
  Eigen::Isometry3d T_map_node = Eigen::Isometry3d::Identity();  ///< where it is
  bool fixed = false;  ///< the optimisation leaves it where it is
};

/// Where an edge comes from; robust kernels are chosen by it.
enum class EdgeKind {
  odometry,
  loop,
  start,  ///< where a session is expected to begin in an earlier map, until it recognises a place
};
/// The enumerator's name.
constexpr std::string_view to_string(EdgeKind kind) {
  return kind == EdgeKind::loop ? "loop" : kind == EdgeKind::start ? "start" : "odometry";
}

/// Only active edges are optimised; the others stay on record.
enum class EdgeStatus { active, candidate, revoked };
/// The enumerator's name.
constexpr std::string_view to_string(EdgeStatus status) {
  return status == EdgeStatus::active      ? "active"
         : status == EdgeStatus::candidate ? "candidate"
                                           : "revoked";
}

/// A measured pose of node `to` in the frame of node `from`.
struct PoseEdge {
  NodeId from = 0;  ///< whose frame the measurement is in
  NodeId to = 0;    ///< that was measured
  Eigen::Isometry3d T_from_to = Eigen::Isometry3d::Identity();  ///< the measurement
  /// The residual's, ordered [translation, rotation] (1/m^2, 1/rad^2): symmetric, without negative
  /// eigenvalues. Directions that the edge says nothing about have none.
  Matrix6d information = Matrix6d::Identity();
  EdgeKind kind = EdgeKind::odometry;      ///< where it comes from
  EdgeStatus status = EdgeStatus::active;  ///< whether it counts
};

/// Where a point of a node was measured to lie in the world.
struct PositionFix {
  NodeId node = 0;                                    ///< it belongs to
  Eigen::Vector3d p_node = Eigen::Vector3d::Zero();   ///< the point in the node's axes, m
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();  ///< m
  /// 1/m^2, world axes: symmetric, without negative eigenvalues.
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
};

/// Which way an axis of a node was measured to point in the level of the world.
struct MeasuredHeading {
  NodeId node = 0;                                       ///< whose axis it is
  Eigen::Vector3d axis_node = Eigen::Vector3d::UnitX();  ///< in the node's axes, of length 1
  double yaw = 0.0;          ///< of it, about the world's vertical from its x axis, rad
  double information = 0.0;  ///< 1/rad^2
};

/// A node whose z axis was measured to point up in the world.
struct LevelledNode {
  NodeId node = 0;           ///< which
  double information = 0.0;  ///< 1/rad^2, about each of the two level axes
};

/// A graph that cannot be optimised. what() says which node or edge is wrong, and why.
class GraphError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Nodes in order of their ids, edges in the order in which they were added. Nodes may be tied to
/// the world, too, by positions and by levels; where the map lies in it is a variable then.
class PoseGraph {
 public:
  /// `planar`: poses are (x, y, yaw) in the plane z = 0 and edges are compared in these alone.
  explicit PoseGraph(bool planar = false) : planar_(planar) {}

  /// Poses are (x, y, yaw).
  bool planar() const { return planar_; }
  /// In order of their ids.
  const std::vector<PoseNode>& nodes() const { return nodes_; }
  /// In the order in which they were added.
  const std::vector<PoseEdge>& edges() const { return edges_; }

  /// Ids may come in any order; increasing ones cost nothing extra. Throws GraphError: the id is
  /// taken, the pose is not finite or, in a planar graph, not in the plane.
  void add_node(const PoseNode& node);

  /// Throws GraphError: no such nodes, both the same, not finite, or an information that is not
  /// symmetric or has a negative eigenvalue.
  void add_edge(const PoseEdge& edge);

  /// `edge` is its position in edges().
  void set_status(std::size_t edge, EdgeStatus status) { edges_.at(edge).status = status; }
  /// Whether the optimisation leaves the node where it is.
  void set_fixed(NodeId id, bool fixed) { nodes_[index_of(id)].fixed = fixed; }
  /// Where the optimisation starts from.
  void set_pose(NodeId id, const Eigen::Isometry3d& T_map_node) {
    nodes_[index_of(id)].T_map_node = T_map_node;
  }
  /// All poses at once, in the order of nodes().
  void set_poses(std::span<const Eigen::Isometry3d> poses);

  /// What ties nodes to the world by position.
  const std::vector<PositionFix>& fixes() const { return fixes_; }
  /// What ties nodes to the world by direction, besides fixes: it gives the map no place by itself.
  const std::vector<MeasuredHeading>& headings() const { return headings_; }
  /// What ties nodes to the vertical.
  const std::vector<LevelledNode>& levels() const { return levels_; }
  /// Throw GraphError: no such node, not finite, or an information that is none. Not for planar
  /// graphs.
  void add_fix(const PositionFix& fix);
  /// As add_fix().
  void add_level(const LevelledNode& level);
  /// As add_fix().
  void add_heading(const MeasuredHeading& heading);
  /// The map has no place in the world any more, nor a heading.
  void clear_fixes() {
    fixes_.clear();
    headings_.clear();
  }

  /// Where the map lies in the world.
  const Eigen::Isometry3d& T_world_map() const { return T_world_map_; }
  /// Where the optimisation starts from.
  void set_T_world_map(const Eigen::Isometry3d& T_world_map) { T_world_map_ = T_world_map; }

  /// The same with other informations of the edges: `scaled(edge)` gives them.
  template <class Scaled>
  PoseGraph with_information(const Scaled& scaled) const {
    PoseGraph result = *this;
    for (PoseEdge& edge : result.edges_) {
      edge.information = scaled(edge);
    }
    return result;
  }

  /// The same with the odometry's covariances counted so many times.
  PoseGraph with_odometry_scaled(double scale) const;

  /// Positions in edges() of those that touch the node, whatever their status, as they were added.
  std::span<const std::size_t> edges_of(NodeId id) const { return edges_of_[index_of(id)]; }
  /// There is a node of that id.
  bool contains(NodeId id) const;
  /// Position in nodes(). Throws GraphError where there is none of that id.
  std::size_t index_of(NodeId id) const;

 private:
  void require_in_space(NodeId id, const std::string& name) const;

  bool planar_;
  std::vector<PoseNode> nodes_;
  std::vector<PoseEdge> edges_;
  std::vector<std::vector<std::size_t>> edges_of_;  ///< indices of each node's edges
  std::vector<PositionFix> fixes_;
  std::vector<LevelledNode> levels_;
  std::vector<MeasuredHeading> headings_;
  Eigen::Isometry3d T_world_map_ = Eigen::Isometry3d::Identity();
};

/// An active edge says where a session is expected to begin.
bool expects_start(const PoseGraph& graph);

/// Nodes that active edges tie to each other.
struct GraphComponent {
  NodeId first = 0;             ///< the lowest id
  std::size_t nodes = 0;        ///< how many
  std::size_t edges = 0;        ///< active ones
  bool has_fixed_node = false;  ///< one at least
};

/// Which component each node belongs to, in the order of nodes(); components in order of `first`.
struct GraphComponents {
  std::vector<GraphComponent> components;  ///< in order of `first`
  std::vector<std::size_t> component_of;   ///< of each node, in the order of nodes()
};
/// What active edges tie together.
GraphComponents connected_components(const PoseGraph& graph);

/// First nodes of the components in which no node is fixed: held where they are, they give the
/// others a place. In order of ids.
std::vector<NodeId> nodes_to_hold(const GraphComponents& components);

/// In the order of nodes().
std::vector<Eigen::Isometry3d> poses_of(const PoseGraph& graph);

}  // namespace adit
