// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/graph_information.hpp"

#include <algorithm>

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
      Eigen::Matrix<double, 6, 12> by_both;
      by_both << row.by_first, row.by_second;
      add({{place_of(edge.from), 6}, {place_of(edge.to), 6}}, by_both.transpose() * by_both,
          by_both.transpose() * row.residual);
    }
  }
}

template <int kRows>
void GraphInformation::add_tie(NodeId node, const WhitenedTie<kRows>& tie) {
  Eigen::Matrix<double, kRows, 12> by_both;
  by_both << tie.by_world, tie.by_node;
  add({{kWorld, 6}, {place_of(node), 6}}, by_both.transpose() * by_both,
      by_both.transpose() * tie.residual);
}

void GraphInformation::add_fixes() {
  for (const PositionFix& fix : graph_->fixes()) {
    add_tie(fix.node,
            FixResidual(fix).linearized(graph_->T_world_map(),
                                        graph_->nodes()[graph_->index_of(fix.node)].T_map_node));
  }
}

void GraphInformation::add_headings() {
  for (const MeasuredHeading& heading : graph_->headings()) {
    add_tie(heading.node,
            HeadingResidual(heading).linearized(
                graph_->T_world_map(), graph_->nodes()[graph_->index_of(heading.node)].T_map_node));
  }
}

void GraphInformation::add_levels() {
  for (const LevelledNode& level : graph_->levels()) {
    add_tie(level.node,
            LevelResidual(level).linearized(
                graph_->T_world_map(), graph_->nodes()[graph_->index_of(level.node)].T_map_node));
  }
}

void GraphInformation::add(std::initializer_list<Block> blocks,
                           const Eigen::Ref<const Eigen::MatrixXd>& information,
                           const Eigen::Ref<const Eigen::VectorXd>& gradient) {
  std::vector<Eigen::Index> at;  // of each row; -1: it does not move
  for (const Block& block : blocks) {
    for (Eigen::Index i = 0; i < block.size; ++i) {
      at.push_back(block.at ? *block.at + i : -1);
    }
  }
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (at[i] < 0) {
      continue;
    }
    const auto row = static_cast<Eigen::Index>(i);
    gradient_(at[i]) += gradient(row);
    for (std::size_t j = 0; j < at.size(); ++j) {
      if (at[j] >= 0 && at[j] <= at[i]) {
        entries_.emplace_back(at[i], at[j], information(row, static_cast<Eigen::Index>(j)));
      }
    }
  }
}

Eigen::SparseMatrix<double> GraphInformation::matrix() const {
  std::vector<Eigen::Triplet<double>> entries = entries_;
  for (Eigen::Index i = 0; i < size(); ++i) {
    entries.emplace_back(i, i, kWeak);
  }
  Eigen::SparseMatrix<double> matrix(size(), size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace adit
