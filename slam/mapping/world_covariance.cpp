// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/world_covariance.hpp"

#include <algorithm>
#include <optional>

#include <Eigen/SparseCholesky>

#include "adit/slam/mapping/graph_residuals.hpp"

namespace adit {
namespace {

/// Position of a block of six in the information; none: it does not move.
using Place = std::optional<Eigen::Index>;

class Information {
 public:
  explicit Information(Eigen::Index size) : matrix_(size, size) {}

  template <int kRows>
  void add(Place a, const Eigen::Matrix<double, kRows, 6>& by_a, Place b,
           const Eigen::Matrix<double, kRows, 6>& by_b) {
    block(a, by_a, a, by_a);
    block(a, by_a, b, by_b);
    block(b, by_b, a, by_a);
    block(b, by_b, b, by_b);
  }

  void add_weak_prior(Eigen::Index size) {
    constexpr double kWeak = 1e-8;
    for (Eigen::Index i = 0; i < size; ++i) {
      entries_.emplace_back(i, i, kWeak);
    }
  }

  const Eigen::SparseMatrix<double>& matrix() {
    matrix_.setFromTriplets(entries_.begin(), entries_.end());
    return matrix_;
  }

 private:
  template <int kRows>
  void block(Place row, const Eigen::Matrix<double, kRows, 6>& by_row, Place column,
             const Eigen::Matrix<double, kRows, 6>& by_column) {
    if (!row || !column) {
      return;
    }
    const Matrix6d product = by_row.transpose() * by_column;
    for (Eigen::Index i = 0; i < 6; ++i) {
      for (Eigen::Index j = 0; j < 6; ++j) {
        entries_.emplace_back(*row + i, *column + j, product(i, j));
      }
    }
  }

  Eigen::SparseMatrix<double> matrix_;
  std::vector<Eigen::Triplet<double>> entries_;
};

}  // namespace

std::vector<Eigen::Matrix3d> world_covariances(const PoseGraph& graph,
                                               std::span<const NodeId> nodes) {
  const std::vector<NodeId> held = nodes_to_hold(connected_components(graph));
  constexpr Eigen::Index kWorld = 0;
  Eigen::Index size = 6;
  std::vector<Place> places;
  for (const PoseNode& node : graph.nodes()) {
    const bool moves = !node.fixed && !std::ranges::binary_search(held, node.id);
    places.push_back(moves ? Place(size) : std::nullopt);
    size += moves ? 6 : 0;
  }
  const auto pose = [&](NodeId id) { return graph.nodes()[graph.index_of(id)].T_map_node; };
  const auto place = [&](NodeId id) { return places[graph.index_of(id)]; };
  Information information(size);
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.status == EdgeStatus::active) {
      const WhitenedEdge<6> row = EdgeResidual<6>(edge, ResidualConvention::rotation)
                                      .linearized(pose(edge.from), pose(edge.to), true);
      information.add<6>(place(edge.from), row.by_first, place(edge.to), row.by_second);
    }
  }
  for (const PositionFix& fix : graph.fixes()) {
    const auto row = FixResidual(fix).linearized(graph.T_world_map(), pose(fix.node));
    information.add<3>(kWorld, row.by_world, place(fix.node), row.by_node);
  }
  for (const LevelledNode& level : graph.levels()) {
    const auto row = LevelResidual(level).linearized(graph.T_world_map(), pose(level.node));
    information.add<2>(kWorld, row.by_world, place(level.node), row.by_node);
  }
  information.add_weak_prior(size);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(information.matrix());
  if (solver.info() != Eigen::Success) {
    return {};
  }
  std::vector<Eigen::Matrix3d> covariances;
  const Eigen::Matrix3d& R_world_map = graph.T_world_map().linear();
  for (const NodeId id : nodes) {
    const Eigen::Isometry3d T_map_node = pose(id);
    Eigen::MatrixXd by_all = Eigen::MatrixXd::Zero(size, 3);
    by_all.block<3, 3>(kWorld, 0) = R_world_map.transpose();
    by_all.block<3, 3>(kWorld + 3, 0) = (-R_world_map * skew(T_map_node.translation())).transpose();
    if (const Place at = place(id)) {
      by_all.block<3, 3>(*at, 0) = (R_world_map * T_map_node.linear()).transpose();
    }
    const Eigen::Matrix3d covariance = by_all.transpose() * solver.solve(by_all);
    covariances.push_back(0.5 * (covariance + covariance.transpose()));
  }
  return covariances;
}

}  // namespace adit
