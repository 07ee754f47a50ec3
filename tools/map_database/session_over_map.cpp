// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/map_database/session_over_map.hpp"

#include <algorithm>
#include <iterator>

namespace adit {
namespace {

template <class T>
std::vector<T> joined(std::vector<T> first, const std::vector<T>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

}  // namespace

SessionOverMap::SessionOverMap(const MapDatabase& map, MapDatabase& own) : map_(&map), own_(&own) {
  const PoseGraph graph = map.graph();
  first_own_ = graph.nodes().empty() ? 0 : graph.nodes().back().id + 1;
  map_edges_ = graph.edges().size();
  if (const auto georeference = map.georeference()) {
    own.revise({.georeference = georeference});
  }
}

// Those of the session alone.
std::vector<PoseEdge> SessionOverMap::take_edges(const std::vector<PoseEdge>& edges) {
  std::vector<PoseEdge> taken;
  for (const PoseEdge& edge : edges) {
    const bool own = is_between_own(edge.from, edge.to);
    own_edges_.push_back(own ? std::optional(stored_edges_++) : std::nullopt);
    if (own) {
      taken.push_back(edge);
    }
  }
  return taken;
}

void SessionOverMap::store(const KeyframeRecord& record) {
  KeyframeRecord own = record;
  own.edges = take_edges(record.edges);
  std::erase_if(own.candidates,
                [&](const LoopCandidate& one) { return !is_between_own(one.from, one.to); });
  own_->store(own);
}

void SessionOverMap::revise(const MapRevision& revision) {
  MapRevision own = revision;
  own.edges = take_edges(revision.edges);
  std::erase_if(own.candidates,
                [&](const LoopCandidate& one) { return !is_between_own(one.from, one.to); });
  std::erase_if(own.poses, [&](const PoseNode& node) { return !is_own(node.id); });
  std::erase_if(own.fixes, [&](const MapFix& fix) { return !is_own(fix.keyframe); });
  if (own.headings) {
    std::erase_if(*own.headings, [&](const MapHeading& one) { return !is_own(one.keyframe); });
  }
  own.georeference.reset();
  own.drops_georeference = false;
  own.statuses.clear();
  for (const auto& [edge, status] : revision.statuses) {
    if (edge >= map_edges_ && own_edges_.at(edge - map_edges_)) {
      own.statuses.emplace_back(*own_edges_[edge - map_edges_], status);
    }
  }
  own_->revise(own);
}

std::vector<MapKeyframe> SessionOverMap::keyframes() const {
  return joined(map_->keyframes(), own_->keyframes());
}

PoseGraph SessionOverMap::graph() const {
  PoseGraph graph = map_->graph();
  const PoseGraph own = own_->graph();
  for (const PoseNode& node : own.nodes()) {
    graph.add_node(node);
  }
  for (const LevelledNode& level : own.levels()) {
    graph.add_level(level);
  }
  for (const PoseEdge& edge : own.edges()) {
    graph.add_edge(edge);
  }
  return graph;
}

std::vector<LoopCandidate> SessionOverMap::candidates() const {
  return joined(map_->candidates(), own_->candidates());
}

std::vector<MapFix> SessionOverMap::fixes() const {
  return joined(map_->fixes(), own_->fixes());
}

std::vector<MapHeading> SessionOverMap::headings() const {
  return joined(map_->headings(), own_->headings());
}

std::vector<NodeId> SessionOverMap::submaps_within(const Eigen::Vector3d& lower,
                                                   const Eigen::Vector3d& upper) const {
  return joined(map_->submaps_within(lower, upper), own_->submaps_within(lower, upper));
}

}  // namespace adit
