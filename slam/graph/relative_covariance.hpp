// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How well a graph knows places relative to one of them: covariances compounded along the least
// uncertain path (docs/theory/loops.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "adit/slam/graph/odometry_drift.hpp"
#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

/// A node as it is seen from the one that was asked for.
struct RelativePlace {
  /// As the edges of the path have measured it, whatever an optimisation has made of them.
  Eigen::Isometry3d T_start_node = Eigen::Isometry3d::Identity();
  /// Covariance of its pose in that one's frame: right perturbation [rho, phi], its own axes.
  Matrix6d covariance = Matrix6d::Zero();
  DriftResponse response = DriftResponse::Zero();  ///< of that perturbation, along its odometry
  double path = 0.0;                               ///< m, along the edges of the path
};

/// What an edge's information leaves unknown, as a covariance: directions without information have
/// standard deviations of 10 m and 1 rad.
Matrix6d covariance_of(const PoseEdge& edge);

/// Response of the product of two poses to an odometry's drift.
DriftResponse compounded(const DriftResponse& first, const Eigen::Isometry3d& T_second,
                         const DriftResponse& second);

/// Covariance of the product of two poses whose errors are independent.
Matrix6d compounded(const Matrix6d& first, const Eigen::Isometry3d& T_second,
                    const Matrix6d& second);

/// Covariance of the inverse of a pose.
Matrix6d inverted(const Eigen::Isometry3d& pose, const Matrix6d& covariance);

/// The least uncertain path from a node to each other that active edges tie to it: the one with the
/// least sum of its edges' variances, a rotation's counted as what it moves a point 10 m away.
struct LeastUncertainPaths {
  static constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

  std::size_t start = 0;            ///< index of that node
  double lumps = 1.0;               ///< see RelativeCovariances::paths_from()
  std::vector<uint32_t> last_edge;  ///< by node: of its path; kNone: the start, or no path
  std::vector<uint32_t> order;      ///< nodes that are reached, each behind the one before it
};

/// A graph's edges with their covariances, worked out once for all places that are asked for.
class RelativeCovariances {
 public:
  /// `graph` must outlive it; what is asked for is by the edges that it has now.
  explicit RelativeCovariances(const PoseGraph& graph);

  /// Covariances of the odometry's edges count `lumps` times: few of them may hold most of its
  /// errors.
  LeastUncertainPaths paths_from(NodeId node, double lumps = 1.0) const;

  /// How `node` is known from the start of the paths; nothing where none reaches it. Other cycles
  /// are left out, so that the covariance is rather too large.
  std::optional<RelativePlace> place(const LeastUncertainPaths& paths, NodeId node) const;

  /// The same for each node, in the order of the graph's.
  std::vector<std::optional<RelativePlace>> places(const LeastUncertainPaths& paths) const;

 private:
  Matrix6d known(std::size_t edge, double lumps) const;
  std::size_t before(const LeastUncertainPaths& paths, std::size_t node) const;
  RelativePlace extended(const RelativePlace& place, std::size_t edge, std::size_t next,
                         double lumps) const;

  const PoseGraph* graph_;
  std::vector<Matrix6d> covariances_;     ///< by edge
  std::vector<DriftResponse> responses_;  ///< the same
};

/// RelativeCovariances::places() of the paths from one node.
std::vector<std::optional<RelativePlace>> relative_places(const PoseGraph& graph, NodeId node,
                                                          double lumps = 1.0);

}  // namespace adit
