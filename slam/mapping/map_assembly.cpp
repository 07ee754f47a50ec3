// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/map_assembly.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "adit/slam/graph/loop_optimization.hpp"
#include "adit/slam/submaps/submap_codec.hpp"

namespace adit {
namespace {

// m. Of odometry between keyframes that are recognised: it drifts by some centimetres on that way.
constexpr double kRecognisedLately = 20.0;
constexpr double kNoKeyframeIsNear = 20.0;

}  // namespace

MapAssembly::MapAssembly(engine::Context& context, const Config& config, MapStore& store,
                         const MapMemory& memory, EarlierSessions earlier)
    : store_(&store),
      memory_(memory),
      delay_(config.mapping.delay),
      world_(config.gnss),
      earlier_(earlier) {
  if (config.mapping.loops) {
    loops_.emplace(context, config, submap_loader(store), memory);
  }
  if (earlier != EarlierSessions::none) {
    begin_behind(read_stored_map(context, store, earlier), config.gnss);
  }
}

// The new session begins as a part of its own at the origin, until a loop ties it.
void MapAssembly::begin_behind(StoredMap earlier, const GnssConfig& gnss) {
  if (loops_) {
    loops_->begin_behind(earlier.places, std::move(earlier.aliases), earlier.last_candidate);
  }
  graph_ = std::move(earlier.graph);
  earlier_nodes_ = graph_.nodes().size();
  T_odom_keyframes_ = poses_of(graph_);
  if (earlier_nodes_ > 0) {
    start_.keyframe = graph_.nodes().back().id + 1;
    localization_.state = LocalizationState::searching;
  }
  if (!earlier.fixes.empty()) {
    start_.fix = earlier.fixes.back().id + 1;
    start_.path = earlier.fixes.back().path;
  }
  georeference_ = earlier.georeference;
  if (earlier_nodes_ > 0 && georeference_) {
    start_by_fixes_.emplace(*georeference_, gnss.correlation, gnss.height);
  }
  const auto used = static_cast<std::size_t>(
      std::ranges::count(earlier.fixes, FixVerdict::used, &MapFix::verdict));
  if (earlier_ == EarlierSessions::keep) {
    uses_fixes_ = false;
    graph_.clear_fixes();
  } else if (graph_.fixes().size() > used) {
    uses_fixes_ = false;  // the map's control points place it, and stay with its graph
  } else {
    world_.begin_behind(std::move(earlier.fixes), std::move(earlier.headings), georeference_);
  }
}

void MapAssembly::begin_at(const ExpectedStart& start) {
  if (earlier_nodes_ > 0) {
    T_map_odom_ = start.T_map_odom;
    start_covariance_ = start.covariance;
    start_by_fixes_.reset();
    localization_.start = StartSource::guess;
  }
}

// The nearest keyframe of the map's first part gets an edge to the newest one.
void MapAssembly::tie_start(const Matrix6d& covariance) {
  const PoseNode& newest = graph_.nodes().back();
  const std::vector<std::size_t> part_of = connected_components(graph_).component_of;
  const auto apart = [&](std::size_t i) {
    return (graph_.nodes()[i].T_map_node.translation() - newest.T_map_node.translation()).norm();
  };
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < earlier_nodes_; ++i) {
    nearest = part_of[i] == part_of.front() && apart(i) < apart(nearest) ? i : nearest;
  }
  const PoseEdge edge = start_edge(graph_.nodes()[nearest], newest, covariance);
  start_edge_ = graph_.edges().size();
  graph_.add_edge(edge);
  store_->revise({.edges = {edge}});
}

// Where the session's fixes say that it is, all of its keyframes move there. Its odometry may have
// started anew: the newest ones count.
void MapAssembly::start_by_fixes(const AssembledKeyframe& added) {
  if (!added.edge) {
    start_by_fixes_->clear();
  }
  if (added.fixes.empty()) {
    return;
  }
  const std::vector<std::size_t> part_of = connected_components(known_graph()).component_of;
  if (part_of.back() == part_of.front()) {  // places were recognised
    start_by_fixes_.reset();
    return;
  }
  start_by_fixes_->add(added.fixes, added.T_odom_keyframe);
  const Eigen::Vector3d up = added.submap->vertical == Vertical::unknown
                                 ? Eigen::Vector3d(Eigen::Vector3d::UnitZ())
                                 : Eigen::Vector3d(added.T_odom_keyframe.linear().col(2));
  const auto start = start_by_fixes_->find(up, added.T_odom_keyframe);
  if (!start) {
    return;
  }
  const Eigen::Isometry3d T_moved = start->T_map_odom * T_map_odom_.inverse();
  for (std::size_t i = earlier_nodes_; i < graph_.nodes().size(); ++i) {
    if (part_of[i] == part_of.back()) {
      const PoseNode& node = graph_.nodes()[i];
      graph_.set_pose(node.id, orthonormalized(T_moved * node.T_map_node));
    }
  }
  T_map_odom_ = orthonormalized(start->T_map_odom);
  localization_.start = StartSource::fixes;
  tie_start(start->covariance);
  start_by_fixes_.reset();
}

// What was expected is no measurement: it counts until places are recognised. Where these lie
// elsewhere, the loop closer has revoked it.
void MapAssembly::release_start() {
  if (!start_edge_) {
    return;
  }
  localization_.start_contradicted = graph_.edges()[*start_edge_].status != EdgeStatus::active;
  if (!localization_.start_contradicted) {
    graph_.set_status(*start_edge_, EdgeStatus::revoked);
    store_->revise({.statuses = {{*start_edge_, EdgeStatus::revoked}}});
  }
  start_edge_.reset();
}

// Near: within the range in which loops are searched for by position.
void MapAssembly::localize() {
  if (!localization_.any()) {
    return;
  }
  const std::size_t newest = graph_.nodes().size() - 1;
  if (localization_.recognised == 0 && newest > earlier_nodes_) {
    localization_.searched += odometry_path(newest - 1, newest);
  }
  localization_.recognised = 0;
  localization_.covariance.setZero();
  std::optional<std::size_t> last;  // the latest node that a loop ties to an earlier session
  for (const PoseEdge& edge : graph_.edges()) {
    if (edge.kind == EdgeKind::loop && edge.status == EdgeStatus::active &&
        edge.from < start_.keyframe && edge.to >= start_.keyframe) {
      ++localization_.recognised;
      last = std::max(last.value_or(0), graph_.index_of(edge.to));
    }
  }
  if (last || (start_edge_ && graph_.edges()[*start_edge_].status != EdgeStatus::active)) {
    release_start();
  }
  if (!last) {
    localization_.state = loops_ && loops_->is_ambiguous() ? LocalizationState::ambiguous
                                                           : LocalizationState::searching;
    ++localization_.keyframes[static_cast<std::size_t>(localization_.state)];
    return;
  }
  const double path = localization_.path = odometry_path(*last, newest);
  const auto places = relative_places(known_graph(), graph_.nodes()[newest].id);
  const RelativePlace* best = nullptr;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < earlier_nodes_; ++i) {
    nearest = std::min(nearest, (graph_.nodes()[i].T_map_node.translation() -
                                 graph_.nodes()[newest].T_map_node.translation())
                                    .norm());
    if (places[i] &&
        (best == nullptr || places[i]->covariance.trace() < best->covariance.trace())) {
      best = &*places[i];
    }
  }
  if (best != nullptr) {
    localization_.covariance = inverted(best->T_start_node, best->covariance);
  }
  localization_.state = best == nullptr               ? LocalizationState::lost
                        : path <= kRecognisedLately   ? LocalizationState::localized
                        : nearest > kNoKeyframeIsNear ? LocalizationState::outside
                                                      : LocalizationState::unconfirmed;
  ++localization_.keyframes[static_cast<std::size_t>(localization_.state)];
}

// m, between two keyframes of the session.
double MapAssembly::odometry_path(std::size_t from, std::size_t to) const {
  double path = 0.0;
  for (std::size_t i = from + 1; i <= to; ++i) {
    path += (T_odom_keyframes_[i - 1].inverse() * T_odom_keyframes_[i]).translation().norm();
  }
  return path;
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
  if (const auto covariance = std::exchange(start_covariance_, std::nullopt)) {
    tie_start(*covariance);
  }
  if (uses_fixes_) {
    world_.add(added.fixes);
    world_.add(added.headings);
  }
  T_odom_keyframes_.push_back(added.T_odom_keyframe);
  due_.push_back({.at = keyframe.id + delay_, .keyframe = keyframe.id, .edge = added.edge});
  if (start_by_fixes_) {
    start_by_fixes(added);
  }
  if (loops_) {
    due_.back().loops = loops_->find(known_graph(), *added.submap, *added.cloud);
  }
  take_effect(keyframe.id);
  localize();
}

void MapAssembly::finish() {
  take_effect(std::numeric_limits<NodeId>::max());
  if (loops_) {
    close_loops(loops_->finish(graph_), graph_.nodes().size());
  }
  release_start();
  settle();
  tie_to_world(world_.finish(graph_, can_optimize()), graph_.nodes().size());
  MapRevision final_poses{.poses = graph_.nodes()};
  if (earlier_ == EarlierSessions::keep) {
    final_poses.poses.erase(
        final_poses.poses.begin(),
        final_poses.poses.begin() + static_cast<std::ptrdiff_t>(earlier_nodes_));
  } else if (!uses_fixes_) {
    final_poses.georeference = placed(georeference_, graph_.T_world_map());
  }
  store_->revise(final_poses);
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
  if (!change.edges.empty() || !change.records.empty() || !change.statuses.empty()) {
    store_->revise(
        {.edges = change.edges, .candidates = change.records, .statuses = change.statuses});
  }
  if (change.moved && last_tied < graph_.nodes().size()) {
    follow(last_tied);
  }
}

void MapAssembly::tie_to_world(const GnssConstraints::Change& change, std::size_t last_tied) {
  if (!change.fixes.empty() || change.georeference) {
    store_->revise({.fixes = change.fixes,
                    .headings = change.headings,
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
