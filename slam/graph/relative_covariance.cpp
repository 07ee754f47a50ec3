// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/relative_covariance.hpp"

#include <ranges>
#include <span>

#include <Eigen/Cholesky>
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
  // All is better known than that as a rule, and its inverse costs a tenth of the eigenvalues.
  if ((scaled - Matrix6d::Identity()).llt().info() == Eigen::Success) {
    return symmetric(edge.information.llt().solve(Matrix6d::Identity()));
  }
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

Matrix6d RelativeCovariances::covariance(std::size_t edge, double lumps) const {
  const bool drifts = graph_->edges()[edge].kind == EdgeKind::odometry;
  return (drifts ? lumps : 1.0) * covariances_[edge];
}

LeastUncertainPaths::LeastUncertainPaths(const RelativeCovariances& known, NodeId from,
                                         double lumps)
    : known_(&known),
      start_(known.graph().index_of(from)),
      lumps_(lumps),
      last_edge_(known.graph().nodes().size(), kNone),
      reached_(last_edge_.size(), std::numeric_limits<double>::infinity()),
      settled_(last_edge_.size(), false) {
  reached_[start_] = 0.0;
  open_.emplace(0.0, static_cast<uint32_t>(start_));
}

void LeastUncertainPaths::search_for(std::size_t node) {
  const PoseGraph& graph = known_->graph();
  while (!settled_[node] && !open_.empty()) {
    const uint32_t at = std::get<1>(open_.top());
    open_.pop();
    if (settled_[at]) {
      continue;
    }
    settled_[at] = true;
    order_.push_back(at);
    const NodeId id = graph.nodes()[at].id;
    for (const std::size_t index : graph.edges_of(id)) {
      const PoseEdge& edge = graph.edges()[index];
      const std::size_t next = graph.index_of(edge.from == id ? edge.to : edge.from);
      if (edge.status != EdgeStatus::active || settled_[next]) {
        continue;
      }
      const double sum = reached_[at] + spread(known_->covariance(index, lumps_));
      if (sum < reached_[next]) {
        reached_[next] = sum;
        last_edge_[next] = static_cast<uint32_t>(index);
        open_.emplace(sum, static_cast<uint32_t>(next));
      }
    }
  }
}

std::size_t LeastUncertainPaths::before(std::size_t node) const {
  const PoseGraph& graph = known_->graph();
  const PoseEdge& edge = graph.edges()[last_edge_[node]];
  const std::size_t from = graph.index_of(edge.from);
  return from == node ? graph.index_of(edge.to) : from;
}

RelativePlace LeastUncertainPaths::extended(const RelativePlace& place, std::size_t next) const {
  const std::size_t edge = last_edge_[next];
  const PoseEdge& step = known_->graph().edges()[edge];
  const bool forward = known_->graph().index_of(step.to) == next;
  const Matrix6d own = known_->covariance(edge, lumps_);
  const DriftResponse& response = known_->response(edge);
  return {
      .T_start_node = place.T_start_node * (forward ? step.T_from_to : step.T_from_to.inverse()),
      .covariance = forward ? compounded(place.covariance, step.T_from_to, own)
                            : compounded(place.covariance, step.T_from_to.inverse(),
                                         inverted(step.T_from_to, own)),
      .response = forward ? compounded(place.response, step.T_from_to, response)
                          : compounded(place.response, step.T_from_to.inverse(),
                                       -adjoint(step.T_from_to) * response),
      .path = place.path + step.T_from_to.translation().norm()};
}

std::optional<RelativePlace> LeastUncertainPaths::place(NodeId node) {
  std::size_t at = known_->graph().index_of(node);
  search_for(at);
  std::vector<std::size_t> way;  // nodes, the last one first
  for (; at != start_; at = before(at)) {
    if (last_edge_[at] == kNone) {
      return std::nullopt;
    }
    way.push_back(at);
  }
  RelativePlace place;
  for (const std::size_t next : std::views::reverse(way)) {
    place = extended(place, next);
  }
  return place;
}

std::vector<std::optional<RelativePlace>> LeastUncertainPaths::places() {
  std::vector<std::optional<RelativePlace>> places(last_edge_.size());
  for (std::size_t node = 0; node < places.size(); ++node) {
    search_for(node);
  }
  places[start_].emplace();
  for (const uint32_t next : std::span(order_).subspan(1)) {
    places[next] = extended(*places[before(next)], next);
  }
  return places;
}

std::vector<std::optional<RelativePlace>> relative_places(const PoseGraph& graph, NodeId node,
                                                          double lumps) {
  const RelativeCovariances known(graph);
  return LeastUncertainPaths(known, node, lumps).places();
}

}  // namespace adit
