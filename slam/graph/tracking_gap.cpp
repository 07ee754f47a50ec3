// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/graph/tracking_gap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace adit {
namespace {

constexpr double kGapSpeed = 1.0;  // m/s
constexpr double kHaste = 1.5;     // times the highest speed before
constexpr double kGapReach = 0.5;  // m
constexpr double kSteepest = 0.3;  // m of climb a metre of that way: as fast up stairs
constexpr double kGapClimb = 0.3;  // m

/// Keyframes in a row that are tied one to the next.
struct Stretch {
  std::size_t first = 0;  ///< indices of nodes
  std::size_t last = 0;
  std::size_t part = 0;
  double reach = 0.0;  ///< of the gap before it; infinite: it is not known
  double climb = 0.0;
};

std::vector<Stretch> stretches_of(const PoseGraph& graph, std::span<const std::size_t> part_of,
                                  std::span<const TrackingGap> gaps) {
  std::vector<Stretch> stretches;
  for (std::size_t i = 0; i < graph.nodes().size(); ++i) {
    const auto gap = std::ranges::find(gaps, graph.nodes()[i].id, &TrackingGap::after);
    if (gap != gaps.end()) {
      stretches.push_back(
          {.first = i, .last = i, .part = part_of[i], .reach = gap->reach, .climb = gap->climb});
    } else if (stretches.empty() || part_of[i] != stretches.back().part) {
      stretches.push_back({.first = i,
                           .last = i,
                           .part = part_of[i],
                           .reach = std::numeric_limits<double>::infinity()});
    } else {
      stretches.back().last = i;
    }
  }
  return stretches;
}

}  // namespace

TrackingGap tracking_gap(NodeId after, double seconds, double speed) {
  const double way = seconds * std::max(kGapSpeed, kHaste * speed);
  return {.after = after, .reach = kGapReach + way, .climb = kGapClimb + kSteepest * way};
}

std::vector<GapCrossing> gap_crossings(const PoseGraph& graph, std::span<const std::size_t> part_of,
                                       std::span<const TrackingGap> gaps, std::size_t one_part,
                                       std::size_t other_part) {
  const std::vector<PoseNode>& nodes = graph.nodes();
  std::vector<GapCrossing> crossings;
  const Stretch* before = nullptr;  // the last one of the two parts
  GapCrossing since;
  const std::vector<Stretch> stretches = stretches_of(graph, part_of, gaps);
  for (const Stretch& stretch : stretches) {
    since.reach += stretch.reach;
    since.climb += stretch.climb;
    if (stretch.part != one_part && stretch.part != other_part) {
      const Eigen::Vector3d way =
          (nodes[stretch.first].T_map_node.inverse() * nodes[stretch.last].T_map_node)
              .translation();
      since.reach += way.head<2>().norm();
      since.between += way.head<2>().norm();
      since.rise += way.z();
      continue;
    }
    if (before != nullptr && before->part != stretch.part && std::isfinite(since.reach)) {
      since.last = nodes[before->last].id;
      since.first = nodes[stretch.first].id;
      crossings.push_back(since);
    }
    before = &stretch;
    since = {};
  }
  return crossings;
}

}  // namespace adit
