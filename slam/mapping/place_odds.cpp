// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/place_odds.hpp"

#include <cmath>

namespace adit {
namespace {

using Kind = PlaceLikeness::Kind;

// As for a session's first place (loop_closer_join.cpp): m, between keyframes that see the same,
// horizontally and vertically, and between keyframes that are evidence of their own.
constexpr double kBeside = 3.0;
constexpr double kSameFloor = 1.5;
constexpr double kLeastApart = 2.0;

// One in ten right places looks different (decision 0037), nineteen of twenty others do:
// log(0.1 / 0.95).
constexpr double kDifferent = -2.25;
// Nobody carries a sensor away more often than once in a thousand stretches between keyframes that
// are recognised: log(1000).
constexpr double kStays = 6.9;
constexpr double kSure = 4.6;        // log(100)
constexpr double kElsewhere = -3.0;  // log(1 / 20)

}  // namespace

Kind likeness_by_position(const PoseGraph& graph, NodeId keyframe,
                          std::span<const PendingLoop> found, std::size_t earlier_nodes) {
  const Eigen::Isometry3d& T_map_keyframe = graph.nodes()[graph.index_of(keyframe)].T_map_node;
  Kind kind = Kind::not_mapped;
  for (const PendingLoop& one : found) {
    const std::size_t from = graph.index_of(one.loop.from);
    const Eigen::Vector3d apart =
        T_map_keyframe.translation() - graph.nodes()[from].T_map_node.translation();
    if (from >= earlier_nodes || one.loop.source != LoopSource::position ||
        apart.head<2>().norm() > kBeside || std::abs(apart.z()) > kSameFloor) {
      continue;
    }
    // What fits, though it could also be farther along, is no evidence of another place.
    const bool fits = one.record.verdict == CandidateVerdict::waiting ||
                      one.record.reason == to_string(LoopReason::degenerate) ||
                      one.record.reason == to_string(LoopReason::ambiguous);
    if (fits) {
      return Kind::alike;
    }
    kind = Kind::different;
  }
  return kind;
}

void PlaceOdds::add(NodeId keyframe, Kind kind, double path) {
  path_ += path;
  if (kind == Kind::alike) {
    reset();
  } else if (kind == Kind::different && (different_ == 0 || path_ >= kLeastApart)) {
    since_ = since_.value_or(keyframe);
    ++different_;
    path_ = 0.0;
  }
}

double PlaceOdds::log_odds() const {
  return kStays + kDifferent * static_cast<double>(different_);
}

bool PlaceOdds::is_sure() const {
  return log_odds() >= kSure;
}

bool PlaceOdds::is_elsewhere() const {
  return log_odds() <= kElsewhere;
}

}  // namespace adit
