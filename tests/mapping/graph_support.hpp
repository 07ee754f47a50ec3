// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "adit/benchmarks/simulated_graph.hpp"
#include "adit/slam/graph/pose_graph.hpp"

namespace adit::test {

inline PoseEdge edge(NodeId from, NodeId to, const Eigen::Isometry3d& T_from_to,
                     double information = 100.0) {
  PoseEdge edge;
  edge.from = from;
  edge.to = to;
  edge.T_from_to = T_from_to;
  edge.information *= information;
  edge.kind = to - from == 1 ? EdgeKind::odometry : EdgeKind::loop;
  return edge;
}

inline Eigen::Isometry3d step(double x, double yaw = 0.0) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation().x() = x;
  pose.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return pose;
}

/// m upwards, and turned by rad.
inline Eigen::Isometry3d up(double z, double yaw = 0.0) {
  Eigen::Isometry3d pose(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  pose.translation().z() = z;
  return pose;
}

/// Of a pose known to so many m and rad along and about each axis.
inline Matrix6d diagonal_covariance(double translation, double rotation) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(translation * translation),
      Eigen::Vector3d::Constant(rotation * rotation);
  return variances.asDiagonal();
}

/// Nodes a metre apart along x, each tied to the one before.
inline PoseGraph line(NodeId nodes) {
  PoseGraph graph;
  for (NodeId id = 0; id < nodes; ++id) {
    graph.add_node({.id = id, .T_map_node = step(static_cast<double>(id))});
    if (id > 0) {
      graph.add_edge(edge(id - 1, id, step(1.0)));
    }
  }
  return graph;
}

/// The largest difference between entries of two lists of poses.
inline double largest_difference(const std::vector<Eigen::Isometry3d>& a,
                                 const std::vector<Eigen::Isometry3d>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, (a[i].matrix() - b[i].matrix()).cwiseAbs().maxCoeff());
  }
  return largest;
}

}  // namespace adit::test
