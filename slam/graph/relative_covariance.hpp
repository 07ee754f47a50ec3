// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How well a graph knows places relative to one of them: covariances compounded along the least
// uncertain path (docs/theory/loops.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <queue>
#include <tuple>
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

/// A graph's edges with their covariances, worked out once for all places that are asked for.
class RelativeCovariances {
 public:
  /// `graph` must outlive it; what is asked for is by the edges that it has now.
  explicit RelativeCovariances(const PoseGraph& graph);

  const PoseGraph& graph() const { return *graph_; }
  /// Of an edge, by its index. Covariances of the odometry's edges count `lumps` times: few of them
  /// may hold most of its errors.
  Matrix6d covariance(std::size_t edge, double lumps) const;
  const DriftResponse& response(std::size_t edge) const { return responses_[edge]; }

 private:
  const PoseGraph* graph_;
  std::vector<Matrix6d> covariances_;     ///< by edge
  std::vector<DriftResponse> responses_;  ///< the same
};

/// The least uncertain path from a node to each other that active edges tie to it: the one with the
/// least sum of its edges' variances, a rotation's counted as what it moves a point 10 m away.
/// Paths are looked for (Dijkstra 1959) as far as they are asked for. Other cycles are left out, so
/// that covariances are rather too large.
class LeastUncertainPaths {
 public:
  /// `known` must outlive it; for `lumps` see there. Throws GraphError where there is no such node.
  LeastUncertainPaths(const RelativeCovariances& known, NodeId from, double lumps = 1.0);

  /// How `node` is known from the start; nothing where no path reaches it.
  std::optional<RelativePlace> place(NodeId node);
  /// The same for each node, in the order of the graph's.
  std::vector<std::optional<RelativePlace>> places();

 private:
  static constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();
  // By spread, then by index: ties do not depend on anything else.
  using Entry = std::tuple<double, uint32_t>;

  /// Settles nodes, the nearest first, until that one is settled or none is left.
  void search_for(std::size_t node);
  std::size_t before(std::size_t node) const;
  RelativePlace extended(const RelativePlace& place, std::size_t next) const;

  const RelativeCovariances* known_;
  std::size_t start_;
  double lumps_;
  std::vector<uint32_t> last_edge_;  ///< by node: of its path; kNone: the start, or no path
  std::vector<double> reached_;      ///< by node: spread of its path
  std::vector<bool> settled_;        ///< by node
  std::vector<uint32_t> order_{};    ///< nodes that are settled, each behind the one before it
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open_{};
};

/// LeastUncertainPaths::places() from one node.
std::vector<std::optional<RelativePlace>> relative_places(const PoseGraph& graph, NodeId node,
                                                          double lumps = 1.0);

}  // namespace adit
