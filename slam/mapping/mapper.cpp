// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/mapper.hpp"

#include <array>
#include <chrono>
#include <limits>
#include <utility>

#include "adit/slam/mapping/submap_alignment.hpp"
#include "adit/slam/mapping/submap_codec.hpp"
#include "adit/slam/registration/beam_spacing.hpp"

namespace adit {

Mapper::Mapper(engine::Context& context, const Config& config, MapStore& store, SessionId session,
               uint64_t submap_bytes)
    : context_(&context),
      config_(config),
      store_(&store),
      session_(session),
      beam_spacing_(config.preprocess.beam_spacing),
      builder_(context, config.preprocess, config.mapping.r_submap),
      clouds_(context, config.preprocess),
      aligner_(context, submap_alignment_settings(config, method_of(config.registration))) {
  if (config.mapping.loops) {
    loops_.emplace(context, config, store, submap_bytes);
  }
}

MapPlacement Mapper::add(const Sweep& sweep, const SweepResult& result,
                         std::span<const Point> cloud) {
  if (beam_spacing_ == 0.0) {
    beam_spacing_ = measured_beam_spacing(sweep.points).value_or(0.0);
  }
  const bool restarted = result.state == OdometryState::restarted;
  if (!open_ || result.keyframe || restarted || builder_.full()) {
    if (open_) {
      freeze();
    }
    open_ = Open{.id = next_++,
                 .lidar = {result.stamp, result.T_map_lidar, result.uncertainty},
                 .detached = restarted};
  }
  const bool believed = result.state != OdometryState::coasting;
  builder_.add({.stamp = result.stamp,
                .T_odom_lidar = result.T_map_lidar,
                .cloud = believed ? cloud : std::span<const Point>(),
                .gravity_odom = result.inertial.gravity_map});
  last_sweep_ = result.stamp;
  ++report_.sweeps;
  return {.keyframe = open_->id, .T_map_lidar = T_map_odom_ * result.T_map_lidar};
}

void Mapper::finish() {
  store_->begin_end(last_sweep_);
  if (open_) {
    freeze();
  }
  take_effect(std::numeric_limits<NodeId>::max());
  if (loops_) {
    close_loops(loops_->finish(graph_), graph_.nodes().size());
    report_.loops = loops_->report();
  }
  store_->revise({.poses = graph_.nodes()});
  report_.components = connected_components(graph_).components.size();
}

// Whatever fails on the way, it is open no more: its sweeps have left the builder.
void Mapper::freeze() {
  const auto start = std::chrono::steady_clock::now();
  const Open open = *std::exchange(open_, std::nullopt);
  const FrozenSubmap frozen = builder_.freeze(beam_spacing_);
  const KeyframeSubmap& submap = frozen.submap;
  const Eigen::Isometry3d T_map_keyframe = T_map_odom_ * frozen.T_odom_keyframe;
  const Eigen::Isometry3d& T_keyframe_lidar = submap.sweeps.front().T_keyframe_lidar;
  store_->store({.keyframe = {.id = open.id,
                              .session = session_,
                              .stamp = submap.sweeps.front().stamp,
                              .T_map_keyframe = T_map_keyframe,
                              .covariance = in_keyframe_axes(open.lidar.uncertainty.in_map(),
                                                             T_keyframe_lidar)},
                 .submap = encode(submap)});
  graph_.add_node({.id = open.id, .T_map_node = T_map_keyframe});
  T_odom_keyframes_.push_back(frozen.T_odom_keyframe);

  const SurfaceCloud cloud = make_surface_cloud(*context_, submap);
  if (last_ && !open.detached) {
    due_.push_back(
        {.at = open.id + config_.mapping.delay, .edge = tie(*last_, open, frozen, cloud)});
  }
  if (loops_) {
    std::vector<PendingLoop> found = loops_->find(known_graph(), submap, cloud);
    if (!found.empty()) {
      due_.back().loops = std::move(found);
    }
  }
  const bool has_points = cloud.size > 0;
  last_.emplace(Frozen{.id = open.id,
                       .lidar = open.lidar,
                       .T_odom_keyframe = frozen.T_odom_keyframe,
                       .target = has_points
                                     ? clouds_.make_target(cloud, aligner_.settings().method,
                                                           std::array{config_.registration.r_align})
                                     : AlignmentTarget(),
                       .has_points = has_points});
  ++report_.keyframes;
  report_.points += submap.points.size();
  report_.seen_through += submap.points.size() - cloud.size;
  report_.lost_points += frozen.lost_points;
  take_effect(open.id);
  report_.keyframe_ms.push_back(
      std::chrono::duration<float, std::milli>(std::chrono::steady_clock::now() - start).count());
}

// What the odometry and an alignment of the two submaps say of the way between them.
PoseEdge Mapper::tie(const Frozen& from, const Open& to, const FrozenSubmap& submap,
                     const SurfaceCloud& cloud) {
  const KeyframeMotion odometry =
      odometry_motion(from.lidar, to.lidar, from.T_odom_keyframe.inverse() * submap.T_odom_keyframe,
                      submap.submap.sweeps.front().T_keyframe_lidar);
  ++report_.edges;
  if (from.has_points && cloud.size > 0) {
    const AlignmentPair pair{.source = &cloud,
                             .target = &from.target,
                             .T_target_source = odometry.T_from_to,
                             .prior_information = edge_of(from.id, to.id, odometry).information};
    const RegistrationResult aligned = aligner_.align(std::span(&pair, 1)).front();
    if (is_usable(aligned.status)) {
      ++report_.aligned_edges;
      if (loops_) {
        loops_->add_expected_rms(aligned.residual_rms);
      }
      return edge_of(from.id, to.id, combined(odometry, motion_of(aligned)));
    }
  }
  return edge_of(from.id, to.id, odometry);
}

// The graph with the edges that are known but have had no effect yet.
PoseGraph Mapper::known_graph() const {
  PoseGraph graph = graph_;
  for (const Due& due : due_) {
    graph.add_edge(due.edge);
  }
  return graph;
}

// Each edge places its later node, and all that came after moves along; so it does where a loop
// moves the graph.
void Mapper::take_effect(NodeId until) {
  std::vector<PoseEdge> edges;
  const auto store_edges = [&] {
    if (!edges.empty()) {
      store_->revise({.edges = edges});
      edges.clear();
    }
  };
  for (; !due_.empty() && due_.front().at <= until; due_.pop_front()) {
    const PoseEdge& edge = due_.front().edge;
    edges.push_back(edge);
    graph_.add_edge(edge);
    graph_.set_pose(edge.to,
                    graph_.nodes()[graph_.index_of(edge.from)].T_map_node * edge.T_from_to);
    const std::size_t to = graph_.index_of(edge.to);
    follow(to);
    if (loops_) {
      store_edges();
      close_loops(loops_->take_effect(graph_, edge.to, std::move(due_.front().loops)), to);
    }
  }
  store_edges();
}

// What loops have changed, for the store and for what came after the last node with an edge.
void Mapper::close_loops(const LoopCloser::Change& change, std::size_t last_tied) {
  MapRevision revision{.edges = change.edges, .candidates = change.records};
  for (const std::size_t edge : change.revoked) {
    revision.statuses.emplace_back(edge, EdgeStatus::revoked);
  }
  if (!revision.edges.empty() || !revision.candidates.empty()) {
    store_->revise(revision);
  }
  if (change.moved && last_tied < graph_.nodes().size()) {
    follow(last_tied);
  }
}

void Mapper::follow(std::size_t last_tied) {
  T_map_odom_ = orthonormalized(graph_.nodes()[last_tied].T_map_node *
                                T_odom_keyframes_[last_tied].inverse());
  for (std::size_t i = last_tied + 1; i < graph_.nodes().size(); ++i) {
    graph_.set_pose(graph_.nodes()[i].id, T_map_odom_ * T_odom_keyframes_[i]);
  }
}

}  // namespace adit
