// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/graph_information.hpp"

#include <algorithm>

#include "adit/slam/mapping/graph_residuals.hpp"

namespace adit {

GraphInformation::GraphInformation(const PoseGraph& graph, Eigen::Index further) : graph_(&graph) {
  const std::vector<NodeId> held = nodes_to_hold(connected_components(graph));
  Eigen::Index size = 6;
  for (const PoseNode& node : graph.nodes()) {
    const bool moves = !node.fixed && !std::ranges::binary_search(held, node.id);
    places_.push_back(moves ? Place(size) : std::nullopt);
    size += moves ? 6 : 0;
  }
  further_ = size;
  gradient_.setZero(size + further);
}

void GraphInformation::add_edges() {
  const auto pose = [&](NodeId id) { return graph_->nodes()[graph_->index_of(id)].T_map_node; };
  for (const PoseEdge& edge : graph_->edges()) {
    if (edge.status == EdgeStatus::active) {
      const WhitenedEdge<6> row = EdgeResidual<6>(edge, ResidualConvention::rotation)
                                      .linearized(pose(edge.from), pose(edge.to), true);
      add(row.residual, {{place_of(edge.from), row.by_first}, {place_of(edge.to), row.by_second}});
    }
  }
}

void GraphInformation::add_fixes() {
  for (const PositionFix& fix : graph_->fixes()) {
    const auto row = FixResidual(fix).linearized(
        graph_->T_world_map(), graph_->nodes()[graph_->index_of(fix.node)].T_map_node);
    add(row.residual, {{kWorld, row.by_world}, {place_of(fix.node), row.by_node}});
  }
}

void GraphInformation::add_levels() {
  for (const LevelledNode& level : graph_->levels()) {
    const auto row = LevelResidual(level).linearized(
        graph_->T_world_map(), graph_->nodes()[graph_->index_of(level.node)].T_map_node);
    add(row.residual, {{kWorld, row.by_world}, {place_of(level.node), row.by_node}});
  }
}

void GraphInformation::add(const Eigen::Ref<const Eigen::VectorXd>& residual,
                           std::initializer_list<Term> terms, double weight) {
  for (const Term& row : terms) {
    if (!row.at) {
      continue;
    }
    gradient_.segment(*row.at, row.by.cols()) += weight * (row.by.transpose() * residual);
    for (const Term& column : terms) {
      if (!column.at) {
        continue;
      }
      const Rows product = weight * (row.by.transpose() * column.by);
      for (Eigen::Index i = 0; i < product.rows(); ++i) {
        for (Eigen::Index j = 0; j < product.cols(); ++j) {
          entries_.emplace_back(*row.at + i, *column.at + j, product(i, j));
        }
      }
    }
  }
}

Eigen::SparseMatrix<double> GraphInformation::matrix() const {
  constexpr double kWeak = 1e-8;
  std::vector<Eigen::Triplet<double>> entries = entries_;
  for (Eigen::Index i = 0; i < size(); ++i) {
    entries.emplace_back(i, i, kWeak);
  }
  Eigen::SparseMatrix<double> matrix(size(), size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace adit
