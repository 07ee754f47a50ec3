// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The normal equations of a whole graph with its place in the world.
#pragma once

#include <initializer_list>
#include <optional>
#include <vector>

#include <Eigen/SparseCore>

#include "adit/slam/graph/graph_residuals.hpp"
#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

/// H x = -g of the steps x that T_world_map (six, first), the nodes that may move (six each) and
/// further variables (last) would take from where they are, by their tangent vectors.
class GraphInformation {
 public:
  /// Where a variable begins in x; none: it does not move.
  using Place = std::optional<Eigen::Index>;
  /// A variable of so many entries.
  struct Block {
    Place at;
    Eigen::Index size = 0;
  };

  /// Nothing is known yet. The graph must outlive it.
  explicit GraphInformation(const PoseGraph& graph, Eigen::Index further = 0);

  /// Of T_world_map.
  static constexpr Eigen::Index kWorld = 0;
  Place place_of(NodeId node) const { return places_[graph_->index_of(node)]; }
  /// Where the further variables begin.
  Eigen::Index further() const { return further_; }
  Eigen::Index size() const { return gradient_.size(); }

  /// Active edges, with their informations as they are.
  void add_edges();
  void add_fixes();
  void add_headings();
  void add_levels();
  /// Whatever residuals of these variables add: J'J and J'r of them all, whitened.
  void add(std::initializer_list<Block> blocks,
           const Eigen::Ref<const Eigen::MatrixXd>& information,
           const Eigen::Ref<const Eigen::VectorXd>& gradient);

  /// What matrix() adds to the diagonal.
  static constexpr double kWeak = 1e-8;
  /// The lower triangle of H, with kWeak added to its diagonal: what nothing tells stays where it
  /// is.
  Eigen::SparseMatrix<double> matrix() const;
  /// g.
  const Eigen::VectorXd& gradient() const { return gradient_; }

 private:
  template <int kRows>
  void add_tie(NodeId node, const WhitenedTie<kRows>& tie);

  const PoseGraph* graph_;
  std::vector<Place> places_;
  Eigen::Index further_ = 0;
  Eigen::VectorXd gradient_;
  std::vector<Eigen::Triplet<double>> entries_;
};

}  // namespace adit
