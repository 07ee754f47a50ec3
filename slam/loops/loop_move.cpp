// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/loops/loop_move.hpp"

#include <cmath>

#include <Eigen/Cholesky>

#include "adit/slam/graph/relative_poses.hpp"

namespace adit {
namespace {

using Moves = std::vector<std::optional<LoopMove>>;

PoseGraph without_loops(PoseGraph graph) {
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    if (graph.edges()[i].kind == EdgeKind::loop) {
      graph.set_status(i, EdgeStatus::candidate);
    }
  }
  return graph;
}

std::optional<LoopMove> move_of(RelativePoses& relative, const PoseEdge& loop) {
  const std::optional<RelativePose> known = relative.between(loop.to, loop.from);
  if (!known) {
    return std::nullopt;
  }
  const RelativePose error = *known * RelativePose{loop.T_from_to, covariance_of(loop)};
  const Vector6d off = se3_log(error.pose);
  return LoopMove{.metres = error.pose.translation().norm(),
                  .radians = rotation_angle(error.pose.linear()),
                  .chi2 = off.dot(error.covariance.ldlt().solve(off)),
                  .path = known->path};
}

}  // namespace

double LoopMove::sigmas() const {
  return std::sqrt(chi2);
}

Moves moves_from_graph_before(const PoseGraph& graph) {
  PoseGraph before = without_loops(graph);
  const RelativeCovariances covariances(before);
  Moves moves(graph.edges().size());
  const auto is_loop = [&](std::size_t i) { return graph.edges()[i].kind == EdgeKind::loop; };
  for (std::size_t first = 0; first < moves.size(); ++first) {
    if (!is_loop(first)) {
      continue;
    }
    RelativePoses relative(before, covariances, Poses::measured);
    std::size_t end = first;
    for (; end < moves.size() && is_loop(end); ++end) {
      moves[end] = move_of(relative, graph.edges()[end]);
    }
    for (; first < end; ++first) {
      before.set_status(first, graph.edges()[first].status);
    }
  }
  return moves;
}

Moves moves_from_odometry(const PoseGraph& graph) {
  const PoseGraph odometry = without_loops(graph);
  const RelativeCovariances covariances(odometry);
  RelativePoses relative(odometry, covariances, Poses::measured);
  Moves moves(graph.edges().size());
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const PoseEdge& edge = graph.edges()[i];
    if (edge.kind == EdgeKind::loop && edge.status == EdgeStatus::active) {
      moves[i] = move_of(relative, edge);
    }
  }
  return moves;
}

std::optional<LoopMove> farthest_from_odometry(const PoseGraph& graph) {
  std::optional<LoopMove> farthest;
  for (const std::optional<LoopMove>& move : moves_from_odometry(graph)) {
    if (move && (!farthest || move->chi2 > farthest->chi2)) {
      farthest = move;
    }
  }
  return farthest;
}

}  // namespace adit
