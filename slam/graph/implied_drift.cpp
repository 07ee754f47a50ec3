// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/implied_drift.hpp"

#include <algorithm>
#include <cmath>

#include "adit/slam/graph/relative_poses.hpp"

namespace adit {
namespace {

// Two stretches are followed backwards as long as each keyframe of the later one has one of the
// earlier so near, m, at most so many before the last that had.
constexpr double kSamePlace = 2.5;
constexpr std::size_t kNeighbours = 3;
// Two levelled places differ in tilt by less than this, rad.
constexpr double kTilt = 0.035;

/// The active odometry edge to a node from the one before it; null: there is none.
const PoseEdge* edge_before(const PoseGraph& graph, std::size_t at) {
  for (const std::size_t index : graph.edges_of(graph.nodes()[at].id)) {
    const PoseEdge& edge = graph.edges()[index];
    if (edge.kind == EdgeKind::odometry && edge.status == EdgeStatus::active &&
        graph.index_of(edge.to) == at && graph.index_of(edge.from) + 1 == at) {
      return &edge;
    }
  }
  return nullptr;
}

/// A keyframe of the earlier stretch, with the later place in its frame.
struct SamePlace {
  std::size_t node = 0;
  Eigen::Isometry3d T_node_later = Eigen::Isometry3d::Identity();
};

/// The keyframe at or before `earlier` that is nearest to where the later one is claimed to be.
std::optional<SamePlace> same_place(const PoseGraph& graph, std::size_t earlier, std::size_t later,
                                    const Eigen::Isometry3d& T_earlier_later) {
  std::optional<SamePlace> same;
  double nearest = kSamePlace;
  Eigen::Isometry3d T_i_later = T_earlier_later;
  for (std::size_t i = earlier, steps = 0;; --i, ++steps) {
    const double apart = T_i_later.translation().norm();
    if (i < later && apart < nearest) {
      nearest = apart;
      same = {.node = i, .T_node_later = T_i_later};
    }
    const PoseEdge* const edge = i > 0 && steps < kNeighbours ? edge_before(graph, i) : nullptr;
    if (edge == nullptr) {
      return same;
    }
    T_i_later = edge->T_from_to * T_i_later;
  }
}

}  // namespace

std::optional<DriftDifference> drift_difference(RelativePoses& relative,
                                                const ImpliedDrift& claim) {
  const std::optional<RelativePose> known = relative.between(claim.to, claim.from);
  if (!known) {
    return std::nullopt;
  }
  const RelativePose error =
      *known * RelativePose{.pose = claim.T_from_to, .covariance = claim.covariance};
  return DriftDifference{.difference = se3_log(error.pose),
                         .covariance = error.covariance,
                         .response = error.response,
                         .levelled = claim.levelled};
}

bool is_tilted(const Eigen::Isometry3d& T_from_to) {
  return std::acos(std::clamp(T_from_to.linear()(2, 2), -1.0, 1.0)) > kTilt;
}

bool drift_explains(const PoseGraph& graph, RelativePoses& measured, const ImpliedDrift& claim,
                    const OdometryDrift& drift) {
  if (claim.levelled && is_tilted(claim.T_from_to)) {
    return false;
  }
  ImpliedDrift pair = claim;
  while (true) {
    const std::optional<DriftDifference> difference = drift_difference(measured, pair);
    if (!difference) {
      return true;
    }
    if (drift.excess(*difference) > 1.0) {
      return false;
    }
    const std::size_t later = graph.index_of(pair.to);
    const PoseEdge* const back = later > 0 ? edge_before(graph, later) : nullptr;
    if (back == nullptr) {
      return true;
    }
    const auto same = same_place(graph, graph.index_of(pair.from), later - 1,
                                 pair.T_from_to * back->T_from_to.inverse());
    if (!same) {
      return true;  // the stretches part here
    }
    pair.from = graph.nodes()[same->node].id;
    pair.to = graph.nodes()[later - 1].id;
    pair.T_from_to = same->T_node_later;
    const std::optional<RelativePose> way = measured.between(pair.to, pair.from);
    if (way && way->path <= kSamePlace) {
      return true;  // loops that were accepted tie them from here on backwards
    }
  }
}

std::vector<bool> within_loops(const PoseGraph& graph) {
  std::vector<int> changes(graph.nodes().size() + 1);
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.kind == EdgeKind::loop && edge.status == EdgeStatus::active) {
      const auto [first, last] = std::minmax({graph.index_of(edge.from), graph.index_of(edge.to)});
      ++changes[first];
      --changes[last];
    }
  }
  std::vector<bool> result(graph.nodes().size());
  int open = 0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    open += changes[i];
    result[i] = open > 0;
  }
  return result;
}

}  // namespace adit
