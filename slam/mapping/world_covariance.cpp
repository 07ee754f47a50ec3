// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/world_covariance.hpp"

#include <Eigen/SparseCholesky>

#include "adit/slam/mapping/graph_information.hpp"

namespace adit {

std::vector<Eigen::Matrix3d> world_covariances(const PoseGraph& graph,
                                               std::span<const NodeId> nodes) {
  GraphInformation information(graph);
  information.add_edges();
  information.add_fixes();
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

}  // namespace adit
