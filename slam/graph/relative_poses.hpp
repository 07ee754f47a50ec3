// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Relative poses with what is known of them, for the votes on loops.
#pragma once

#include <map>
#include <optional>

#include "adit/slam/graph/relative_covariance.hpp"

namespace adit {

/// A pose with the covariance of its right perturbation, and its response to drift.
struct RelativePose {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Matrix6d covariance = Matrix6d::Zero();
  DriftResponse response = DriftResponse::Zero();
  double path = 0.0;  ///< m, along edges
};

inline RelativePose operator*(const RelativePose& a, const RelativePose& b) {
  return {a.pose * b.pose, compounded(a.covariance, b.pose, b.covariance),
          compounded(a.response, b.pose, b.response), a.path + b.path};
}

inline RelativePose inverse(const RelativePose& a) {
  return {a.pose.inverse(), inverted(a.pose, a.covariance), -adjoint(a.pose) * a.response, a.path};
}

/// Whose word counts for a relative pose: the edges' of the way there, or the graph's, which may
/// have bent some of them for loops far away.
enum class Poses { measured, optimized };

/// Relative poses that the graph knows; paths from a node are looked for once.
class RelativePoses {
 public:
  RelativePoses(const PoseGraph& graph, const RelativeCovariances& covariances, Poses poses,
                double lumps = 1.0)
      : graph_(graph), covariances_(covariances), poses_(poses), lumps_(lumps) {}

  std::optional<RelativePose> between(NodeId from, NodeId to) {
    auto paths = paths_.find(from);
    if (paths == paths_.end()) {
      paths = paths_.emplace(from, LeastUncertainPaths(covariances_, from, lumps_)).first;
    }
    const std::optional<RelativePlace> place = paths->second.place(to);
    if (!place) {
      return std::nullopt;
    }
    const Eigen::Isometry3d pose =
        poses_ == Poses::measured ? place->T_start_node
                                  : graph_.nodes()[graph_.index_of(from)].T_map_node.inverse() *
                                        graph_.nodes()[graph_.index_of(to)].T_map_node;
    return RelativePose{pose, place->covariance, place->response, place->path};
  }

 private:
  const PoseGraph& graph_;
  const RelativeCovariances& covariances_;
  Poses poses_;
  double lumps_;
  std::map<NodeId, LeastUncertainPaths> paths_;
};

}  // namespace adit
