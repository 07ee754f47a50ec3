// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/loop_search.hpp"

#include <algorithm>
#include <tuple>

#include <Eigen/Cholesky>

namespace adit {
namespace {

/// What of a distance is beyond the dead zone, in its direction.
Eigen::Vector3d beyond(const Eigen::Vector3d& difference, double dead_zone) {
  const double norm = difference.norm();
  return norm <= dead_zone ? Eigen::Vector3d::Zero()
                           : Eigen::Vector3d(difference * (1.0 - dead_zone / norm));
}

bool better(const LoopPlace& a, const LoopPlace& b) {
  return std::tuple(a.distance, a.mahalanobis, a.node) <
         std::tuple(b.distance, b.mahalanobis, b.node);
}

}  // namespace

std::vector<LoopPlace> find_loop_places(const PoseGraph& graph, NodeId newest,
                                        std::span<const double> reaches,
                                        const LoopSearchSettings& settings) {
  const std::vector<std::optional<RelativePlace>> known =
      relative_places(graph, newest, settings.lumps);
  const std::size_t self = graph.index_of(newest);
  const Eigen::Isometry3d& T_map_newest = graph.nodes()[self].T_map_node;
  std::vector<LoopPlace> places;
  bool in_stretch = false;
  for (std::size_t i = 0; i < known.size(); ++i) {
    const Eigen::Isometry3d T_newest_node = T_map_newest.inverse() * graph.nodes()[i].T_map_node;
    const double distance = T_newest_node.translation().norm();
    if (i == self || !known[i] || known[i]->path < settings.min_path ||
        distance > settings.max_distance) {
      in_stretch = false;
      continue;
    }
    const double dead_zone = std::max(
        settings.least_dead_zone, settings.dead_zone_share * std::min(reaches[i], reaches[self]));
    // Covariance of the position in the newest one's axes.
    const Eigen::Matrix3d& R = T_newest_node.linear();
    const Eigen::Matrix3d spread =
        R * known[i]->covariance.topLeftCorner<3, 3>() * R.transpose() +
        settings.sigma_floor * settings.sigma_floor * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d away = beyond(T_newest_node.translation(), dead_zone);
    const double mahalanobis = away.dot(spread.ldlt().solve(away));
    if (mahalanobis > settings.gate) {
      in_stretch = false;
      continue;
    }
    const LoopPlace place{.node = graph.nodes()[i].id,
                          .T_node_newest = T_newest_node.inverse(),
                          .covariance = inverted(T_newest_node, known[i]->covariance),
                          .distance = distance,
                          .mahalanobis = mahalanobis,
                          .path = known[i]->path};
    if (!in_stretch) {
      places.push_back(place);
    } else if (better(place, places.back())) {
      places.back() = place;
    }
    in_stretch = true;
  }
  std::ranges::sort(places, better);
  places.resize(std::min(places.size(), settings.most));
  return places;
}

}  // namespace adit
