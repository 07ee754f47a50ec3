// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// How well a graph knows places relative to one of them: covariances compounded along the least
// uncertain path (docs/theory/loops.md).
#pragma once

#include <optional>
#include <vector>

#include "adit/slam/mapping/pose_graph.hpp"

namespace adit {

/// A node as it is seen from the one that was asked for.
struct RelativePlace {
  /// Covariance of its pose in that one's frame: right perturbation [rho, phi], its own axes.
  Matrix6d covariance = Matrix6d::Zero();
  double path = 0.0;  ///< m, along the edges of the path
};

/// What an edge's information leaves unknown, as a covariance: directions without information have
/// standard deviations of 10 m and 1 rad.
Matrix6d covariance_of(const PoseEdge& edge);

/// Covariance of the product of two poses whose errors are independent.
Matrix6d compounded(const Matrix6d& first, const Eigen::Isometry3d& T_second,
                    const Matrix6d& second);

/// Covariance of the inverse of a pose.
Matrix6d inverted(const Eigen::Isometry3d& pose, const Matrix6d& covariance);

/// For each node, in the order of the graph's, how it is known from `node`, by the active edges;
/// nothing for those that no path reaches. The path is the one with the least sum of its edges'
/// variances, a rotation's counted as what it moves a point 10 m away. Other cycles are left out,
/// so that the covariance is rather too large. Covariances of the odometry's edges count `lumps`
/// times: few of them may hold most of its errors.
std::vector<std::optional<RelativePlace>> relative_places(const PoseGraph& graph, NodeId node,
                                                          double lumps = 1.0);

}  // namespace adit
