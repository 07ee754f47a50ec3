// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/map_merge.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "adit/slam/mapping/loop_by_hand.hpp"
#include "adit/slam/mapping/merge_start.hpp"
#include "adit/slam/mapping/start_place.hpp"
#include "adit/slam/mapping/stored_map.hpp"
#include "adit/slam/submaps/submap_codec.hpp"

namespace adit {
namespace {

// Between keyframes that are searched for: nearer ones see nearly the same.
constexpr double kApart = 1.0;        // m, or
constexpr double kTurned = 0.5;       // rad
constexpr std::size_t kTogether = 5;  // keyframes, whose loops vote together

/// What the maps hold, read once.
struct ReadMap {
  StoredMap map;
  std::vector<NodeId> keyframes{};
  std::vector<LoopCandidate> candidates{};
  double rms = 0.0;  ///< m, of alignments of consecutive submaps
};

/// Maps that are tied to each other, and what a search in them needs.
struct Group {
  MergedMap merged;
  std::vector<EarlierPlace> places{};  ///< in the order of the graph's nodes
  int64_t last_candidate = 0;
  std::vector<double> rms{};  ///< by part

  NodeId next() const {
    return merged.graph.nodes().empty() ? 0 : merged.graph.nodes().back().id + 1;
  }
};

MergedPart part_of(const ReadMap& read, std::size_t map, NodeId first) {
  return {.map = map, .first = first, .stored = read.keyframes};
}

/// Nodes with their levels, and edges. Fixes tie a map to the world in a frame of its own: they
/// come in when the merged map is placed.
void append(PoseGraph& graph, const MergedPart& part, const PoseGraph& own) {
  for (const PoseNode& node : own.nodes()) {
    graph.add_node({.id = part.merged(node.id), .T_map_node = node.T_map_node});
  }
  for (LevelledNode level : own.levels()) {
    level.node = part.merged(level.node);
    graph.add_level(level);
  }
  for (PoseEdge edge : own.edges()) {
    edge.from = part.merged(edge.from);
    edge.to = part.merged(edge.to);
    graph.add_edge(edge);
  }
}

std::vector<LoopCandidate> renumbered(const ReadMap& read, const MergedPart& part, int64_t last) {
  std::vector<LoopCandidate> candidates;
  for (LoopCandidate candidate : read.candidates) {
    candidate.id += last;
    candidate.from = part.merged(candidate.from);
    candidate.to = part.merged(candidate.to);
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

/// By node: active edges tie it to one of the `earlier` first ones.
std::vector<bool> tied_to_earlier(const PoseGraph& graph, std::size_t earlier) {
  const std::vector<std::size_t> part_of = connected_components(graph).component_of;
  const std::set<std::size_t> parts(part_of.begin(),
                                    part_of.begin() + static_cast<std::ptrdiff_t>(earlier));
  std::vector<bool> tied;
  for (const std::size_t part : part_of) {
    tied.push_back(parts.contains(part));
  }
  return tied;
}

/// Its submaps fit, whatever came of it then.
bool is_verified(const LoopCandidate& candidate) {
  for (auto reason = static_cast<std::size_t>(LoopReason::not_aligned);
       reason <= static_cast<std::size_t>(LoopReason::seen_through); ++reason) {
    if (candidate.reason == to_string(static_cast<LoopReason>(reason))) {
      return false;
    }
  }
  return true;
}

class Merge {
 public:
  Merge(engine::Context& context, const Config& config, std::span<const MapStore* const> maps,
        const MapMemory& memory, const MergeSettings& settings,
        const std::function<bool(const MergeStep&)>& on_step)
      : context_(&context),
        config_(config),
        maps_(maps),
        memory_(memory),
        settings_(settings),
        on_step_(on_step) {
    config_.mapping.loops = true;
    for (const MapStore* store : maps) {
      ReadMap read{.map = read_stored_map(context, *store, EarlierSessions::move),
                   .candidates = store->candidates(),
                   .rms = usual_rms(context, config_, *store)};
      for (const PoseNode& node : read.map.graph.nodes()) {
        read.keyframes.push_back(node.id);
      }
      if (read.map.georeference) {
        read.map.georeference = with_shared_error(*read.map.georeference, read.map.fixes);
      }
      // Those whose keyframes were lost name nothing.
      std::erase_if(read.candidates, [&](const LoopCandidate& one) {
        return !read.map.graph.contains(one.from) || !read.map.graph.contains(one.to);
      });
      read_.push_back(std::move(read));
    }
  }

  MergedMap run() {
    std::vector<MergeSearch> searches;
    for (std::size_t base = 0;; ++base) {
      Group group = grown_from(base, searches);
      if (group.merged.parts.size() > 1 || base + 2 >= maps_.size()) {
        group.merged.searches = std::move(searches);
        return std::move(group.merged);
      }
    }
  }

 private:
  /// With all later maps that can be tied to it, directly or by way of others.
  Group grown_from(std::size_t base, std::vector<MergeSearch>& searches) {
    Group group;
    const MergedPart part = part_of(read_[base], base, 0);
    append(group.merged.graph, part, read_[base].map.graph);
    take(group, part, renumbered(read_[base], part, 0), {});
    std::vector<std::size_t> left;
    for (std::size_t map = base + 1; map < maps_.size(); ++map) {
      left.push_back(map);
    }
    for (std::size_t before = 0; before != left.size() && !left.empty();) {
      before = left.size();
      std::erase_if(left, [&](std::size_t map) {
        searches.push_back(tie(group, map));
        return searches.back().is_tied;
      });
    }
    return group;
  }

  void take(Group& group, const MergedPart& part, std::vector<LoopCandidate> own,
            const std::map<int64_t, LoopCandidate>& between) {
    const ReadMap& read = read_[part.map];
    std::vector<LoopCandidate>& candidates = group.merged.candidates;
    std::ranges::move(own, std::back_inserter(candidates));
    for (const auto& [id, candidate] : between) {
      candidates.push_back(candidate);
    }
    for (const LoopCandidate& candidate : candidates) {
      group.last_candidate = std::max(group.last_candidate, candidate.id);
    }
    group.places.insert(group.places.end(), read.map.places.begin(), read.map.places.end());
    group.rms.push_back(read.rms);
    group.merged.parts.push_back(part);
  }

  SubmapLoader loader(const Group& group, const MergedPart& part) const {
    std::vector<MergedPart> parts = group.merged.parts;
    parts.push_back(part);
    return [parts = std::move(parts), maps = maps_](NodeId keyframe) {
      const auto after = std::ranges::upper_bound(parts, keyframe, {}, &MergedPart::first);
      const MergedPart& of = *std::prev(after);
      return maps[of.map]->submap(of.stored.at(static_cast<std::size_t>(keyframe - of.first)));
    };
  }

  /// First where both have it in the world; if that ties nothing, by what keyframes look like.
  MergeSearch tie(Group& group, std::size_t map) {
    MergeSearch found = search_for(group, map, true);
    return found.is_tied ? found : search_for(group, map, false);
  }
  MergeSearch search_for(Group& group, std::size_t map, bool in_world);

  engine::Context* context_;
  Config config_;
  std::span<const MapStore* const> maps_;
  MapMemory memory_;
  MergeSettings settings_;
  const std::function<bool(const MergeStep&)>& on_step_;
  std::vector<ReadMap> read_;
};

/// One map searched for in others: first by what its keyframes look like, until they tie it; then
/// all of them by where the tie has them.
class Search {
 public:
  Search(engine::Context& context, LoopCloser& closer, SubmapLoader load, PoseGraph& graph,
         std::size_t earlier, MergeSearch& found,
         const std::function<bool(const MergeStep&)>& on_step)
      : context_(&context),
        closer_(&closer),
        load_(std::move(load)),
        graph_(&graph),
        earlier_(earlier),
        found_(&found),
        on_step_(&on_step),
        noted_(earlier) {}

  /// `own` are the candidates within the later map.
  void run(std::span<const LoopCandidate> own) {
    std::size_t next = earlier_;
    do {
      closer_->set_own_aliases(map_aliases(*graph_, own));
      next = search_by_appearance(next);
      search_by_position();
      closer_->set_own_aliases(map_aliases(*graph_, own));  // with the poses of the tie
      collect(closer_->confirm_join(*graph_));
    } while (next < graph_->nodes().size() && !are_all_tied() && !closer_->is_built_alike());
  }

  /// All candidates between the maps, by id.
  const std::map<int64_t, LoopCandidate>& records() const { return records_; }

 private:
  /// Until the keyframes are tied. Returns where it has stopped.
  std::size_t search_by_appearance(std::size_t next) {
    last_.reset();
    for (; next < graph_->nodes().size() && !are_all_tied(); ++next) {
      const KeyframeSubmap submap = loaded(next);
      const SurfaceCloud cloud = make_surface_cloud(*context_, submap);
      closer_->describe(submap, cloud);
      if (is_due(next) && !is_tied(next)) {
        search(next, submap, cloud);
      }
      report();
    }
    take_effect();
    collect(closer_->finish(*graph_));
    return next;
  }

  void search_by_position() {
    last_.reset();
    for (std::size_t node = earlier_; node < graph_->nodes().size(); ++node) {
      const KeyframeSubmap submap = loaded(node);
      if (is_due(node) && is_tied(node)) {
        search(node, submap, make_surface_cloud(*context_, submap));
      }
      report();
    }
    take_effect();
    collect(closer_->finish(*graph_));
  }

  KeyframeSubmap loaded(std::size_t node) {
    KeyframeSubmap submap = decode(load_(graph_->nodes()[node].id));
    if (node == noted_) {
      closer_->note(submap);
      ++noted_;
    }
    return submap;
  }

  /// It may see something else than the one that was searched for last.
  bool is_due(std::size_t node) {
    const Eigen::Isometry3d& T_map_node = graph_->nodes()[node].T_map_node;
    if (last_) {
      const Eigen::Isometry3d way = graph_->nodes()[*last_].T_map_node.inverse() * T_map_node;
      if (way.translation().norm() < kApart && rotation_angle(way.linear()) < kTurned) {
        return false;
      }
    }
    last_ = node;
    return true;
  }

  bool are_all_tied() const {
    return std::ranges::count(tied_to_earlier(*graph_, earlier_), false) == 0;
  }
  bool is_tied(std::size_t node) const { return tied_to_earlier(*graph_, earlier_)[node]; }

  void search(std::size_t node, const KeyframeSubmap& submap, const SurfaceCloud& cloud) {
    const NodeId id = graph_->nodes()[node].id;
    std::ranges::move(closer_->find_between(*graph_, id, submap, cloud),
                      std::back_inserter(waiting_));
    newest_ = id;
    if (++searched_ == kTogether) {
      take_effect();
    }
  }

  /// What was found votes together, and one optimisation follows.
  void take_effect() {
    if (searched_ > 0) {
      collect(closer_->take_effect(*graph_, newest_, std::exchange(waiting_, {})));
    }
    searched_ = 0;
  }

  void collect(const LoopCloser::Change& change) {
    for (const LoopCandidate& record : change.records) {
      records_[record.id] = record;
    }
  }

  void report() {
    ++done_;
    if (!(*on_step_)({.search = found_, .done = done_})) {
      throw MergeStopped("the merge was stopped");
    }
  }

  engine::Context* context_;
  LoopCloser* closer_;
  SubmapLoader load_;
  PoseGraph* graph_;
  std::size_t earlier_;
  MergeSearch* found_;
  const std::function<bool(const MergeStep&)>* on_step_;
  std::map<int64_t, LoopCandidate> records_;
  std::size_t done_ = 0;
  std::size_t noted_;                 ///< nodes that the closer knows of
  std::optional<std::size_t> last_;   ///< node that was searched for last
  std::vector<PendingLoop> waiting_;  ///< found since the last step
  std::size_t searched_ = 0;          ///< keyframes since then
  NodeId newest_ = 0;                 ///< the latest of them
};

/// Edges between the maps that count, and the keyframes of the later one that they lead to.
void count_edges(const PoseGraph& graph, NodeId first, MergeSearch& found) {
  std::set<NodeId> keyframes;
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.kind == EdgeKind::loop && edge.status == EdgeStatus::active && edge.from < first &&
        edge.to >= first) {
      ++found.accepted;
      keyframes.insert(edge.to);
    }
  }
  found.keyframes = keyframes.size();
}

MergeSearch Merge::search_for(Group& group, std::size_t map, bool in_world) {
  const ReadMap& read = read_[map];
  const MergedPart part = part_of(read, map, group.next());
  MergeSearch found{.map = map};
  for (const MergedPart& one : group.merged.parts) {
    found.in.push_back(one.map);
  }
  PoseGraph graph = group.merged.graph;
  append(graph, part, read.map.graph);
  const std::size_t earlier = group.merged.graph.nodes().size();
  const auto& world = read_[group.merged.parts.front().map].map.georeference;
  if (in_world && (!world || !place_in_earlier(graph, earlier, *world, read.map, config_.gnss))) {
    return found;
  }
  std::vector<LoopCandidate> own = renumbered(read, part, group.last_candidate);
  int64_t last = group.last_candidate;
  for (const LoopCandidate& candidate : own) {
    last = std::max(last, candidate.id);
  }
  const SubmapLoader load = loader(group, part);
  LoopCloser closer(*context_, config_, load, memory_);
  closer.begin_behind(group.places, map_aliases(group.merged.graph, group.merged.candidates), last);
  closer.search_between(part.first, settings_.same_site);
  for (const double rms : group.rms) {
    closer.add_expected_rms(rms);
  }
  closer.add_expected_rms(read.rms);
  Search search(*context_, closer, load, graph, earlier, found, on_step_);
  search.run(own);
  for (const auto& [id, record] : search.records()) {
    ++found.candidates;
    found.verified += is_verified(record) ? 1U : 0U;
  }
  found.log_odds = closer.best_log_odds();
  found.built_alike_log_odds = closer.built_alike_log_odds();
  count_edges(graph, part.first, found);
  found.is_tied = found.keyframes >= LoopVotingSettings{}.least_unexpected;
  if (found.is_tied) {
    group.merged.graph = measured_alone(graph);
    take(group, part, std::move(own), search.records());
  }
  return found;
}

}  // namespace

NodeId MergedPart::merged(NodeId keyframe) const {
  const auto found = std::ranges::lower_bound(stored, keyframe);
  if (found == stored.end() || *found != keyframe) {
    throw GraphError("there is no keyframe " + std::to_string(keyframe));
  }
  return first + static_cast<NodeId>(found - stored.begin());
}

MergedMap merge_maps(engine::Context& context, const Config& config,
                     std::span<const MapStore* const> maps, const MapMemory& memory,
                     const MergeSettings& settings,
                     const std::function<bool(const MergeStep&)>& on_step) {
  return Merge(context, config, maps, memory, settings, on_step).run();
}

}  // namespace adit
