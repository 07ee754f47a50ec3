// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/relative_covariance.hpp"

#include <functional>
#include <limits>
#include <queue>
#include <ranges>
#include <span>
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

DriftResponse compounded(const DriftResponse& first, const Eigen::Isometry3d& T_second,
                         const DriftResponse& second) {
  return adjoint(T_second.inverse()) * first + second;
}

Matrix6d inverted(const Eigen::Isometry3d& pose, const Matrix6d& covariance) {
  const Matrix6d moved = adjoint(pose);
  return symmetric(moved * covariance * moved.transpose());
}

RelativeCovariances::RelativeCovariances(const PoseGraph& graph) : graph_(&graph) {
  covariances_.reserve(graph.edges().size());
  responses_.reserve(graph.edges().size());
  for (const PoseEdge& edge : graph.edges()) {
    covariances_.push_back(edge.status == EdgeStatus::active ? covariance_of(edge)
                                                             : Matrix6d::Zero());
    const Eigen::Matrix3d R_world_to =
        (graph.T_world_map() * graph.nodes()[graph.index_of(edge.to)].T_map_node).linear();
    responses_.push_back(edge.kind == EdgeKind::odometry
                             ? drift_response(edge.T_from_to, R_world_to.row(2).transpose())
                             : DriftResponse::Zero());
  }
}

Matrix6d RelativeCovariances::known(std::size_t edge, double lumps) const {
  const bool drifts = graph_->edges()[edge].kind == EdgeKind::odometry;
  return (drifts ? lumps : 1.0) * covariances_[edge];
}

LeastUncertainPaths RelativeCovariances::paths_from(NodeId node, double lumps) const {
  const std::size_t size = graph_->nodes().size();
  LeastUncertainPaths paths{
      .start = graph_->index_of(node),
      .lumps = lumps,
      .last_edge = std::vector<uint32_t>(size, LeastUncertainPaths::kNone),
      .order = {},
  };
  std::vector<double> reached(size, std::numeric_limits<double>::infinity());
  std::vector<bool> settled(size, false);
  // By spread, then by index: ties do not depend on anything else.
  using Entry = std::tuple<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  reached[paths.start] = 0.0;
  open.emplace(0.0, paths.start);
  while (!open.empty()) {
    const std::size_t at = std::get<1>(open.top());
    open.pop();
    if (settled[at]) {
      continue;
    }
    settled[at] = true;
    paths.order.push_back(static_cast<uint32_t>(at));
    const NodeId id = graph_->nodes()[at].id;
    for (const std::size_t index : graph_->edges_of(id)) {
      const PoseEdge& edge = graph_->edges()[index];
      const std::size_t next = graph_->index_of(edge.from == id ? edge.to : edge.from);
      if (edge.status != EdgeStatus::active || settled[next]) {
        continue;
      }
      const double sum = reached[at] + spread(known(index, lumps));
      if (sum < reached[next]) {
        reached[next] = sum;
        paths.last_edge[next] = static_cast<uint32_t>(index);
        open.emplace(sum, next);
      }
    }
  }
  return paths;
}

std::size_t RelativeCovariances::before(const LeastUncertainPaths& paths, std::size_t node) const {
  const PoseEdge& edge = graph_->edges()[paths.last_edge[node]];
  const std::size_t from = graph_->index_of(edge.from);
  return from == node ? graph_->index_of(edge.to) : from;
}

RelativePlace RelativeCovariances::extended(const RelativePlace& place, std::size_t edge,
                                            std::size_t next, double lumps) const {
  const PoseEdge& step = graph_->edges()[edge];
  const bool forward = graph_->index_of(step.to) == next;
  const Matrix6d own = known(edge, lumps);
  return {
      .T_start_node = place.T_start_node * (forward ? step.T_from_to : step.T_from_to.inverse()),
      .covariance = forward ? compounded(place.covariance, step.T_from_to, own)
                            : compounded(place.covariance, step.T_from_to.inverse(),
                                         inverted(step.T_from_to, own)),
      .response = forward ? compounded(place.response, step.T_from_to, responses_[edge])
                          : compounded(place.response, step.T_from_to.inverse(),
                                       -adjoint(step.T_from_to) * responses_[edge]),
      .path = place.path + step.T_from_to.translation().norm()};
}

std::optional<RelativePlace> RelativeCovariances::place(const LeastUncertainPaths& paths,
                                                        NodeId node) const {
  std::vector<std::size_t> way;  // nodes, the last one first
  std::size_t at = graph_->index_of(node);
  for (; at != paths.start; at = before(paths, at)) {
    if (paths.last_edge[at] == LeastUncertainPaths::kNone) {
      return std::nullopt;
    }
    way.push_back(at);
  }
  RelativePlace place;
  for (const std::size_t next : std::views::reverse(way)) {
    place = extended(place, paths.last_edge[next], next, paths.lumps);
  }
  return place;
}

std::vector<std::optional<RelativePlace>> RelativeCovariances::places(
    const LeastUncertainPaths& paths) const {
  std::vector<std::optional<RelativePlace>> places(graph_->nodes().size());
  places[paths.start].emplace();
  for (const uint32_t next : std::span(paths.order).subspan(1)) {
    places[next] = extended(*places[before(paths, next)], paths.last_edge[next], next, paths.lumps);
  }
  return places;
}

std::vector<std::optional<RelativePlace>> relative_places(const PoseGraph& graph, NodeId node,
                                                          double lumps) {
  const RelativeCovariances covariances(graph);
  return covariances.places(covariances.paths_from(node, lumps));
}

}  // namespace adit
