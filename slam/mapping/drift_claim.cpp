// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/drift_claim.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

namespace adit {
namespace {

// Two stretches are followed backwards as long as each keyframe of the later one has one of the
// earlier so near, m, at most so many before the last that had.
constexpr double kSamePlace = 2.5;
constexpr std::size_t kNeighbours = 3;

/// The shortest way from a node to each, along active edges, m; infinite where there is none.
std::vector<double> ways_from(const PoseGraph& graph, std::size_t start) {
  std::vector<double> ways(graph.nodes().size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  ways[start] = 0.0;
  open.emplace(0.0, start);
  while (!open.empty()) {
    const auto [way, at] = open.top();
    open.pop();
    if (way > ways[at]) {
      continue;
    }
    const NodeId id = graph.nodes()[at].id;
    for (const std::size_t index : graph.edges_of(id)) {
      const PoseEdge& edge = graph.edges()[index];
      const std::size_t next = graph.index_of(edge.from == id ? edge.to : edge.from);
      const double sum = way + edge.T_from_to.translation().norm();
      if (edge.status == EdgeStatus::active && sum < ways[next]) {
        ways[next] = sum;
        open.emplace(sum, next);
      }
    }
  }
  return ways;
}

double angle_about_z(const Eigen::Matrix3d& rotation) {
  return std::abs(std::atan2(rotation(1, 0), rotation(0, 0)));
}

double tilt_of(const Eigen::Matrix3d& rotation) {
  return std::acos(std::clamp(rotation(2, 2), -1.0, 1.0));
}

}  // namespace

bool is_possible_drift(const Eigen::Isometry3d& error, double path, const DriftLimits& limits) {
  const double turn = angle_about_z(error.linear());
  const Eigen::Vector3d& off = error.translation();
  // A turn on the way moves what comes after it aside.
  return turn <= limits.least_turn + limits.turn * path &&
         off.head<2>().norm() <= limits.least_distance + (limits.aside + turn) * path &&
         std::abs(off.z()) <= limits.least_distance + limits.height * path;
}

bool drift_explains(const PoseGraph& graph, NodeId from, NodeId to,
                    const Eigen::Isometry3d& T_from_to, const DriftLimits& limits) {
  const std::vector<PoseNode>& nodes = graph.nodes();
  std::size_t earlier = graph.index_of(from);
  std::size_t later = graph.index_of(to);
  if (tilt_of(T_from_to.linear()) > limits.tilt) {
    return false;
  }
  if (std::isinf(ways_from(graph, later)[earlier])) {
    return true;
  }
  const Eigen::Isometry3d T_claimed_map =
      nodes[earlier].T_map_node * T_from_to * nodes[later].T_map_node.inverse();
  // What was believed of the pair, against what is claimed.
  const auto is_possible = [&](double way) {
    const Eigen::Isometry3d error = T_claimed_map.inverse() * nodes[earlier].T_map_node;
    return is_possible_drift(nodes[earlier].T_map_node.inverse() * error, way, limits);
  };
  if (!is_possible(ways_from(graph, later)[earlier])) {
    return false;
  }
  while (later-- > 0) {
    // The earlier stretch's keyframe where this one of the later stretch is claimed to be.
    const Eigen::Isometry3d claimed = T_claimed_map * nodes[later].T_map_node;
    std::optional<std::size_t> same;
    double nearest = kSamePlace;
    const std::size_t first = earlier - std::min(earlier, kNeighbours);
    for (std::size_t i = first; i <= earlier && i < later; ++i) {
      const double apart = (nodes[i].T_map_node.translation() - claimed.translation()).norm();
      if (apart < nearest) {
        nearest = apart;
        same = i;
      }
    }
    if (!same) {
      return true;  // the stretches part here
    }
    earlier = *same;
    const double way = ways_from(graph, later)[earlier];
    if (way <= kSamePlace) {
      return true;  // loops that were accepted tie them from here on backwards
    }
    if (!is_possible(way)) {
      return false;
    }
  }
  return true;
}

}  // namespace adit
