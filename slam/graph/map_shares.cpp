// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/map_shares.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/SparseCholesky>

#include "adit/slam/graph/graph_information.hpp"

namespace adit {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr std::size_t kKeyframes = 16;

/// The graph with edges of one kind alone, or with none.
PoseGraph with_edges(const PoseGraph& graph, std::optional<EdgeKind> kind) {
  return graph.with_information([&](const PoseEdge& edge) {
    const bool is_loop = edge.kind == EdgeKind::loop;
    const bool chosen = kind && is_loop == (*kind == EdgeKind::loop);
    return chosen ? edge.information : Matrix6d(Matrix6d::Zero());
  });
}

/// Without what matrix() adds to the diagonal.
Sparse information_by(const PoseGraph& graph, MapSource source) {
  const auto matrix_of = [](const GraphInformation& information) {
    Sparse identity(information.size(), information.size());
    identity.setIdentity();
    return Sparse(information.matrix() - GraphInformation::kWeak * identity);
  };
  GraphInformation all(graph);
  switch (source) {
    case MapSource::odometry:
    case MapSource::loops: {
      const PoseGraph chosen =
          with_edges(graph, source == MapSource::loops ? EdgeKind::loop : EdgeKind::odometry);
      GraphInformation edges(chosen);
      edges.add_edges();
      return matrix_of(edges);
    }
    case MapSource::fixes:
      all.add_fixes();
      break;
    case MapSource::headings:
      all.add_headings();
      break;
    case MapSource::verticals:
      all.add_levels();
      break;
  }
  return matrix_of(all);
}

/// Positions in nodes() of those that move, so many of them, evenly chosen, and the last one.
std::vector<std::size_t> chosen_nodes(const PoseGraph& graph, const GraphInformation& places) {
  std::vector<std::size_t> moving;
  for (std::size_t i = 0; i < graph.nodes().size(); ++i) {
    if (places.place_of(graph.nodes()[i].id)) {
      moving.push_back(i);
    }
  }
  const std::size_t count = std::min(kKeyframes, moving.size());
  std::vector<std::size_t> chosen;
  for (std::size_t k = 1; k <= count; ++k) {
    chosen.push_back(moving[k * moving.size() / count - 1]);
  }
  return chosen;
}

}  // namespace

std::optional<MapShares> map_shares(const PoseGraph& graph) {
  const GraphInformation places(graph);
  const std::vector<std::size_t> nodes = chosen_nodes(graph, places);
  if (nodes.empty()) {
    return std::nullopt;
  }
  std::vector<Sparse> parts;
  Sparse sum = places.matrix();  // what keeps it regular
  for (std::size_t i = 0; i < kMapSources; ++i) {
    parts.push_back(information_by(graph, static_cast<MapSource>(i)));
    sum += parts.back();
  }
  const Eigen::SimplicialLDLT<Sparse> solver(sum);
  if (solver.info() != Eigen::Success) {
    return std::nullopt;
  }
  MapShares shares;
  for (const std::size_t node : nodes) {
    const Eigen::Isometry3d& T_map_node = graph.nodes()[node].T_map_node;
    Eigen::MatrixXd by_all = Eigen::MatrixXd::Zero(sum.rows(), 4);  // x, y, z, yaw
    const Eigen::Index at = *places.place_of(graph.nodes()[node].id);
    by_all.block<3, 3>(at, 0) = T_map_node.linear().transpose();
    by_all.block<3, 1>(at + 3, 3) = T_map_node.linear().row(2).transpose();
    const Eigen::MatrixXd moves = solver.solve(by_all);
    const Eigen::Matrix4d covariance = by_all.transpose() * moves;
    const Eigen::Matrix2d level = covariance.topLeftCorner<2, 2>().inverse();
    for (std::size_t i = 0; i < kMapSources; ++i) {
      const Eigen::Matrix4d noise =
          moves.transpose() * (parts[i].selfadjointView<Eigen::Lower>() * moves);
      const std::array share = {0.5 * (level * noise.topLeftCorner<2, 2>()).trace(),
                                noise(2, 2) / covariance(2, 2), noise(3, 3) / covariance(3, 3)};
      for (std::size_t k = 0; k < kMapParts; ++k) {
        shares.of[i][k] += share[k] / static_cast<double>(nodes.size());
      }
    }
  }
  return shares;
}

}  // namespace adit
