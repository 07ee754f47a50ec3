// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The edges of a graph as whitened residuals, for the solver and for the report on its result.
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "adit/slam/graph/between_factor.hpp"
#include "adit/slam/graph/pose_graph.hpp"
#include "adit/slam/graph/solver.hpp"

namespace adit {

/// Where (x, y, yaw) stand in [rho, phi].
inline constexpr int kPlanarRows[3] = {0, 1, 5};

/// The rows of a tangent vector that a node of that many degrees of freedom has: all 6, or the
/// plane's 3.
template <int kFreedom>
Eigen::Matrix<double, kFreedom, 1> chosen_rows(const Vector6d& xi) {
  if constexpr (kFreedom == 6) {
    return xi;
  } else {
    return Eigen::Vector3d(xi(kPlanarRows[0]), xi(kPlanarRows[1]), xi(kPlanarRows[2]));
  }
}

/// The inverse of chosen_rows(), with zeros elsewhere.
template <int kFreedom>
Vector6d lifted(const double* rows) {
  Vector6d xi = Vector6d::Zero();
  if constexpr (kFreedom == 6) {
    xi = Eigen::Map<const Vector6d>(rows);
  } else {
    for (int i = 0; i < 3; ++i) {
      xi(kPlanarRows[i]) = rows[i];
    }
  }
  return xi;
}

template <int kFreedom>
Eigen::Matrix<double, kFreedom, kFreedom> chosen_block(const Matrix6d& matrix) {
  if constexpr (kFreedom == 6) {
    return matrix;
  } else {
    Eigen::Matrix3d block;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        block(row, column) = matrix(kPlanarRows[row], kPlanarRows[column]);
      }
    }
    return block;
  }
}

/// Rows whose squares add up to r' information r: upper triangular where the information is
/// positive definite, scaled eigenvectors where it is not.
template <int kFreedom>
Eigen::Matrix<double, kFreedom, kFreedom> root_information(
    const Eigen::Matrix<double, kFreedom, kFreedom>& information) {
  using Matrix = Eigen::Matrix<double, kFreedom, kFreedom>;
  const Eigen::LLT<Matrix> cholesky(information);
  if (cholesky.info() == Eigen::Success) {
    return cholesky.matrixU();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(information);
  return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

template <int kFreedom>
struct WhitenedEdge {
  Eigen::Matrix<double, kFreedom, 1> residual;
  Eigen::Matrix<double, kFreedom, kFreedom> by_first;   ///< by the first node's tangent vector
  Eigen::Matrix<double, kFreedom, kFreedom> by_second;  ///< by the second's
};

/// An edge's residual as a function of the poses of its nodes.
template <int kFreedom>
class EdgeResidual {
 public:
  EdgeResidual(const PoseEdge& edge, ResidualConvention convention)
      : T_to_from_(edge.T_from_to.inverse()),
        root_(root_information<kFreedom>(chosen_block<kFreedom>(edge.information))),
        convention_(convention) {}

  WhitenedEdge<kFreedom> linearized(const Eigen::Isometry3d& first, const Eigen::Isometry3d& second,
                                    bool jacobians) const {
    const Eigen::Isometry3d relative = first.inverse() * second;
    const BetweenResidual between = between_residual(T_to_from_ * relative, convention_);
    WhitenedEdge<kFreedom> edge;
    edge.residual.noalias() = root_ * chosen_rows<kFreedom>(between.residual);
    if (jacobians) {
      edge.by_second.noalias() = root_ * chosen_block<kFreedom>(between.by_error);
      edge.by_first.noalias() = edge.by_second * chosen_block<kFreedom>(error_by_first(relative));
    }
    return edge;
  }

 private:
  Eigen::Isometry3d T_to_from_;
  Eigen::Matrix<double, kFreedom, kFreedom> root_;
  ResidualConvention convention_;
};

/// A residual between the world and a node; Jacobians by the tangent vectors of T_world_map and
/// T_map_node.
template <int kRows>
struct WhitenedTie {
  Eigen::Matrix<double, kRows, 1> residual;
  Eigen::Matrix<double, kRows, 6> by_world;
  Eigen::Matrix<double, kRows, 6> by_node;
};

/// T_world_map T_map_node p_node - p_world.
class FixResidual {
 public:
  static constexpr int kRows = 3;
  explicit FixResidual(const PositionFix& fix)
      : p_node_(fix.p_node), p_world_(fix.p_world), root_(root_information<3>(fix.information)) {}

  WhitenedTie<kRows> linearized(const Eigen::Isometry3d& T_world_map,
                                const Eigen::Isometry3d& T_map_node) const;

 private:
  Eigen::Vector3d p_node_;
  Eigen::Vector3d p_world_;
  Eigen::Matrix3d root_;
};

/// x and y of the world's vertical in the node's axes: the tilts of the node.
class LevelResidual {
 public:
  static constexpr int kRows = 2;
  explicit LevelResidual(const LevelledNode& level) : root_(std::sqrt(level.information)) {}

  WhitenedTie<kRows> linearized(const Eigen::Isometry3d& T_world_map,
                                const Eigen::Isometry3d& T_map_node) const;

 private:
  double root_;
};

/// The yaw of a node's axis in the world less the measured one, within half a turn of 0. The yaw is
/// that of the axis's projection on the level, as two antennas and a tilt-compensated compass give
/// it. Jacobians are by the turn about the vertical: of tilts a heading says nothing. An axis that
/// stands upright has no yaw: its residual and Jacobians are 0.
class HeadingResidual {
 public:
  static constexpr int kRows = 1;
  explicit HeadingResidual(const MeasuredHeading& heading)
      : axis_node_(heading.axis_node), yaw_(heading.yaw), root_(std::sqrt(heading.information)) {}

  WhitenedTie<kRows> linearized(const Eigen::Isometry3d& T_world_map,
                                const Eigen::Isometry3d& T_map_node) const;

 private:
  Eigen::Vector3d axis_node_;
  double yaw_;
  double root_;
};

/// Residuals of the active edges, with the nodes at these poses.
std::vector<std::optional<EdgeResult>> edge_results(const PoseGraph& graph,
                                                    std::span<const Eigen::Isometry3d> poses,
                                                    const OptimizationSettings& settings);

/// The sum of chi squared under the kernels, fixes, headings and levels included, where the
/// optimisation has come to.
double cost_of(const PoseGraph& graph, const OptimizedGraph& optimized,
               const OptimizationSettings& settings);

}  // namespace adit
