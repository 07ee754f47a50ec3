// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/loops/join_review.hpp"

#include <algorithm>
#include <set>
#include <vector>

namespace adit {

bool crosses(const PoseGraph& graph, const TrackingGap& gap, NodeId from, NodeId to) {
  const auto [first, last] = std::minmax({graph.index_of(from), graph.index_of(to)});
  const std::size_t after = graph.index_of(gap.after);
  return first < after && after <= last;
}

std::size_t agreeing_on_another_join(const PoseGraph& graph, const TrackingGap& gap,
                                     std::span<const LoopHypothesis> refused,
                                     std::span<const LoopHypothesis> accepted,
                                     std::span<const TrackingGap> gaps,
                                     const LoopVotingSettings& settings) {
  const auto goes_across = [&](const LoopHypothesis& one) {
    return crosses(graph, gap, one.from, one.to);
  };
  const auto joins = [&](const PoseEdge& edge) {
    return edge.kind != EdgeKind::odometry && edge.status == EdgeStatus::active &&
           crosses(graph, gap, edge.from, edge.to);
  };
  if (std::ranges::none_of(graph.edges(), joins)) {
    return 0;
  }
  std::vector<LoopHypothesis> asked;
  for (const LoopHypothesis& one : refused) {
    if (goes_across(one)) {
      asked.push_back(one);
    }
  }
  if (asked.size() < settings.least_unexpected) {
    return 0;
  }
  PoseGraph parted = graph;
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    if (joins(graph.edges()[i])) {
      parted.set_status(i, EdgeStatus::revoked);
    }
  }
  const std::vector<std::size_t> part_of = connected_components(parted).component_of;
  std::erase_if(asked, [&](const LoopHypothesis& one) {
    return part_of[graph.index_of(one.from)] == part_of[graph.index_of(one.to)];
  });
  const std::vector<LoopVote> votes = vote(parted, asked, {.gaps = gaps}, false, settings);
  std::set<NodeId> against;
  for (std::size_t i = 0; i < votes.size(); ++i) {
    if (votes[i].accepted) {
      against.insert(asked[i].to);
    }
  }
  if (against.empty()) {
    return 0;
  }
  std::set<NodeId> supporting;
  for (const LoopHypothesis& one : accepted) {
    if (goes_across(one) && one.to >= *against.begin() && one.to <= *against.rbegin()) {
      supporting.insert(one.to);
    }
  }
  return against.size() > supporting.size() ? against.size() : 0;
}

}  // namespace adit
