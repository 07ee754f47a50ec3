// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/relative_covariance.hpp"

#include <limits>
#include <queue>
#include <tuple>

#include <Eigen/Eigenvalues>

namespace adit {
namespace {

constexpr double kUnknownTranslation = 10.0;  // m
constexpr double kUnknownRotation = 1.0;      // rad
constexpr double kLever = 10.0;               // m

double spread(const Matrix6d& covariance) {
  return covariance.topLeftCorner<3, 3>().trace() +
         kLever * kLever * covariance.bottomRightCorner<3, 3>().trace();
}

Matrix6d symmetric(const Matrix6d& matrix) {
  return 0.5 * (matrix + matrix.transpose());
}

}  // namespace

Matrix6d covariance_of(const PoseEdge& edge) {
  Vector6d unit;
  unit << Eigen::Vector3d::Constant(kUnknownTranslation),
      Eigen::Vector3d::Constant(kUnknownRotation);
  // In units in which all that is unknown is equally so; nothing is less known than that.
  const Matrix6d scaled = unit.asDiagonal() * edge.information * unit.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scaled);
  const Vector6d variances = eigen.eigenvalues().array().max(1.0).inverse();
  const Matrix6d axes = unit.asDiagonal() * eigen.eigenvectors();
  return symmetric(axes * variances.asDiagonal() * axes.transpose());
}

Matrix6d compounded(const Matrix6d& first, const Eigen::Isometry3d& T_second,
                    const Matrix6d& second) {
  const Matrix6d moved = adjoint(T_second.inverse());
  return symmetric(moved * first * moved.transpose() + second);
}

Matrix6d inverted(const Eigen::Isometry3d& pose, const Matrix6d& covariance) {
  const Matrix6d moved = adjoint(pose);
  return symmetric(moved * covariance * moved.transpose());
}

std::vector<std::optional<RelativePlace>> relative_places(const PoseGraph& graph, NodeId node,
                                                          double lumps) {
  std::vector<std::optional<RelativePlace>> places(graph.nodes().size());
  std::vector<double> reached(places.size(), std::numeric_limits<double>::infinity());
  // By spread, then by index: ties do not depend on anything else.
  using Entry = std::tuple<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  std::vector<RelativePlace> best(places.size());
  const std::size_t start = graph.index_of(node);
  reached[start] = 0.0;
  open.emplace(0.0, start);
  while (!open.empty()) {
    const std::size_t at = std::get<1>(open.top());
    open.pop();
    if (places[at]) {
      continue;
    }
    places[at] = best[at];
    const NodeId id = graph.nodes()[at].id;
    for (const std::size_t index : graph.edges_of(id)) {
      const PoseEdge& edge = graph.edges()[index];
      const bool forward = edge.from == id;
      const std::size_t next = graph.index_of(forward ? edge.to : edge.from);
      if (edge.status != EdgeStatus::active || places[next]) {
        continue;
      }
      const Matrix6d known = (edge.kind == EdgeKind::odometry ? lumps : 1.0) * covariance_of(edge);
      const double sum = reached[at] + spread(known);
      const double path = best[at].path + edge.T_from_to.translation().norm();
      if (sum >= reached[next]) {
        continue;
      }
      reached[next] = sum;
      best[next] = {.covariance = forward
                                      ? compounded(best[at].covariance, edge.T_from_to, known)
                                      : compounded(best[at].covariance, edge.T_from_to.inverse(),
                                                   inverted(edge.T_from_to, known)),
                    .path = path};
      open.emplace(sum, next);
    }
  }
  return places;
}

}  // namespace adit
