// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/map_assembly.hpp"

#include <limits>
#include <utility>

#include "adit/slam/graph/loop_optimization.hpp"
#include "adit/slam/submaps/submap_codec.hpp"

namespace adit {

MapAssembly::MapAssembly(engine::Context& context, const Config& config, MapStore& store,
                         const MapMemory& memory)
    : store_(&store), memory_(memory), delay_(config.mapping.delay), world_(config.gnss) {
  if (config.mapping.loops) {
    loops_.emplace(context, config, submap_loader(store), memory);
  }
}

void MapAssembly::add_expected_rms(double rms) {
  if (loops_) {
    loops_->add_expected_rms(rms);
  }
}

std::optional<LoopReport> MapAssembly::loops() const {
  return loops_ ? std::optional(loops_->report()) : std::nullopt;
}

void MapAssembly::add(const AssembledKeyframe& added) {
  MapKeyframe keyframe = added.keyframe;
  keyframe.T_map_keyframe = T_map_odom_ * added.T_odom_keyframe;
  std::optional<PlaceDescriptor> descriptor;
  if (loops_) {
    descriptor = loops_->describe(*added.submap, *added.cloud);
  }
  keyframe.vertical = added.submap->vertical;
  store_->store(
      {.keyframe = keyframe, .submap = encode(*added.submap, descriptor), .fixes = added.fixes});
  graph_.add_node({.id = keyframe.id, .T_map_node = keyframe.T_map_keyframe});
  if (!outgrown_ && !can_optimize()) {
    outgrown_ = keyframe.id;
  }
  if (const auto level = level_of(keyframe.id, keyframe.vertical)) {
    graph_.add_level(*level);
  }
  world_.add(added.fixes);
  T_odom_keyframes_.push_back(added.T_odom_keyframe);
  due_.push_back({.at = keyframe.id + delay_, .keyframe = keyframe.id, .edge = added.edge});
  if (loops_) {
    due_.back().loops = loops_->find(known_graph(), *added.submap, *added.cloud);
  }
  take_effect(keyframe.id);
}

void MapAssembly::finish() {
  take_effect(std::numeric_limits<NodeId>::max());
  if (loops_) {
    close_loops(loops_->finish(graph_), graph_.nodes().size());
  }
  settle();
  tie_to_world(world_.finish(graph_, can_optimize()), graph_.nodes().size());
  store_->revise({.poses = graph_.nodes()});
}

// What came after the last loop has followed it as the odometry had it, so that verticals have had
// no say there.
void MapAssembly::settle() {
  if (graph_.levels().empty() || !can_optimize()) {
    return;
  }
  const LoopOptimum optimum = optimize_with_loops(graph_);
  if (optimum.report.termination != Termination::failed) {
    graph_.set_poses(optimum.poses);
    graph_.set_T_world_map(optimum.T_world_map);
  }
}

// The graph with the edges that are known but have had no effect yet.
PoseGraph MapAssembly::known_graph() const {
  PoseGraph graph = graph_;
  for (const Due& due : due_) {
    if (due.edge) {
      graph.add_edge(*due.edge);
    }
  }
  return graph;
}

// Each edge places its later node, and all that came after moves along; so it does where a loop
// moves the graph.
void MapAssembly::take_effect(NodeId until) {
  std::vector<PoseEdge> edges;
  const auto store_edges = [&] {
    if (!edges.empty()) {
      store_->revise({.edges = edges});
      edges.clear();
    }
  };
  for (; !due_.empty() && due_.front().at <= until; due_.pop_front()) {
    Due& due = due_.front();
    const std::size_t at = graph_.index_of(due.keyframe);
    if (due.edge) {
      edges.push_back(*due.edge);
      graph_.add_edge(*due.edge);
      graph_.set_pose(due.keyframe, graph_.nodes()[graph_.index_of(due.edge->from)].T_map_node *
                                        due.edge->T_from_to);
      follow(at);
    }
    if (loops_) {
      store_edges();
      close_loops(loops_->take_effect(graph_, due.keyframe, std::move(due.loops)), at);
    }
    store_edges();
    tie_to_world(world_.take_effect(graph_, due.keyframe, can_optimize()), at);
  }
  store_edges();
}

// What loops have changed, for the store and for what came after the last node with an edge.
void MapAssembly::close_loops(const LoopCloser::Change& change, std::size_t last_tied) {
  if (!change.edges.empty() || !change.records.empty()) {
    store_->revise(
        {.edges = change.edges, .candidates = change.records, .statuses = change.statuses});
  }
  if (change.moved && last_tied < graph_.nodes().size()) {
    follow(last_tied);
  }
}

void MapAssembly::tie_to_world(const WorldTies::Change& change, std::size_t last_tied) {
  if (!change.fixes.empty() || change.georeference) {
    store_->revise({.fixes = change.fixes,
                    .georeference = change.georeference,
                    .drops_georeference = change.place_is_lost});
  }
  if (change.moved && last_tied < graph_.nodes().size()) {
    follow(last_tied);
  }
}

void MapAssembly::follow(std::size_t last_tied) {
  T_map_odom_ = orthonormalized(graph_.nodes()[last_tied].T_map_node *
                                T_odom_keyframes_[last_tied].inverse());
  for (std::size_t i = last_tied + 1; i < graph_.nodes().size(); ++i) {
    graph_.set_pose(graph_.nodes()[i].id, T_map_odom_ * T_odom_keyframes_[i]);
  }
}

}  // namespace adit
