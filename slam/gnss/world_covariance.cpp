// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/gnss/world_covariance.hpp"

#include <Eigen/SparseCholesky>

#include "adit/slam/graph/graph_information.hpp"

namespace adit {

std::vector<Eigen::Matrix3d> world_covariances(const PoseGraph& graph,
                                               std::span<const NodeId> nodes) {
  GraphInformation information(graph);
  information.add_edges();
  information.add_fixes();
  information.add_headings();
  information.add_levels();
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(information.matrix());
  if (solver.info() != Eigen::Success) {
    return {};
  }
  std::vector<Eigen::Matrix3d> covariances;
  const Eigen::Matrix3d& R_world_map = graph.T_world_map().linear();
  for (const NodeId id : nodes) {
    const Eigen::Isometry3d T_map_node = graph.nodes()[graph.index_of(id)].T_map_node;
    Eigen::MatrixXd by_all = Eigen::MatrixXd::Zero(information.size(), 3);
    by_all.block<3, 3>(GraphInformation::kWorld, 0) = R_world_map.transpose();
    by_all.block<3, 3>(GraphInformation::kWorld + 3, 0) =
        (-R_world_map * skew(T_map_node.translation())).transpose();
    if (const auto at = information.place_of(id)) {
      by_all.block<3, 3>(*at, 0) = (R_world_map * T_map_node.linear()).transpose();
    }
    const Eigen::Matrix3d covariance = by_all.transpose() * solver.solve(by_all);
    covariances.push_back(0.5 * (covariance + covariance.transpose()));
  }
  return covariances;
}

Matrix6d covariance_of_world(const PoseGraph& graph) {
  Matrix6d information = 1e-8 * Matrix6d::Identity();
  const auto add = [&](const auto& tie) { information += tie.by_world.transpose() * tie.by_world; };
  const auto pose = [&](NodeId node) { return graph.nodes()[graph.index_of(node)].T_map_node; };
  for (const PositionFix& fix : graph.fixes()) {
    add(FixResidual(fix).linearized(graph.T_world_map(), pose(fix.node)));
  }
  for (const MeasuredHeading& heading : graph.headings()) {
    add(HeadingResidual(heading).linearized(graph.T_world_map(), pose(heading.node)));
  }
  for (const LevelledNode& level : graph.levels()) {
    add(LevelResidual(level).linearized(graph.T_world_map(), pose(level.node)));
  }
  return symmetric_inverse(information);
}

}  // namespace adit
