// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/map_ties.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "adit/slam/core/median.hpp"
#include "adit/slam/graph/loop_optimization.hpp"
#include "adit/slam/mapping/merge_start.hpp"

namespace adit {
namespace {

using Eigen::Isometry3d;

/// A map's own graph and records.
struct OwnMap {
  PoseGraph graph;
  std::vector<NodeId> keyframes{};
  std::vector<LoopCandidate> candidates{};

  const Isometry3d& pose(NodeId keyframe) const {
    return graph.nodes()[graph.index_of(keyframe)].T_map_node;
  }
};

OwnMap own_map(const MapStore& store) {
  OwnMap own{.graph = measured_alone(store.graph()), .candidates = store.candidates()};
  for (const PoseNode& node : own.graph.nodes()) {
    own.keyframes.push_back(node.id);
  }
  std::erase_if(own.candidates, [&](const LoopCandidate& one) {
    return !own.graph.contains(one.from) || !own.graph.contains(one.to);
  });
  return own;
}

/// A map that is tied to one that has its place already.
struct Step {
  std::size_t map = 0;
  std::optional<std::size_t> tie{};  ///< none: the first map
};

/// Maps that ties lead to from `base`, each by the tie with the most tied keyframes that leads out
/// of those before it.
std::vector<Step> reached_from(std::size_t base, std::span<const MapTie> ties,
                               const std::vector<bool>& counts) {
  std::vector<Step> steps = {{.map = base}};
  std::set<std::size_t> there = {base};
  const auto is_there = [&](std::size_t map) { return there.contains(map); };
  for (;;) {
    std::optional<std::size_t> best;
    for (std::size_t i = 0; i < ties.size(); ++i) {
      if (counts[i] && is_there(ties[i].one) != is_there(ties[i].other) &&
          (!best || ties[i].search.keyframes > ties[*best].search.keyframes)) {
        best = i;
      }
    }
    if (!best) {
      return steps;
    }
    const MapTie& tie = ties[*best];
    steps.push_back({.map = is_there(tie.one) ? tie.other : tie.one, .tie = best});
    there.insert(steps.back().map);
  }
}

/// Where the second map lies in the first one: what an edge says of it that has the keyframes of
/// all edges nearest to where these have them.
Isometry3d place_of_other(const MapTie& tie, const OwnMap& one, const OwnMap& other) {
  Isometry3d best = Isometry3d::Identity();
  double least = std::numeric_limits<double>::infinity();
  for (const PoseEdge& edge : tie.edges) {
    const Isometry3d place = one.pose(edge.from) * edge.T_from_to * other.pose(edge.to).inverse();
    double sum = 0.0;
    for (const PoseEdge& check : tie.edges) {
      const Isometry3d measured = one.pose(check.from) * check.T_from_to;
      sum += (place * other.pose(check.to).translation() - measured.translation()).norm();
    }
    if (sum < least) {
      least = sum;
      best = place;
    }
  }
  return orthonormalized(best);
}

class Join {
 public:
  Join(std::span<const MapStore* const> maps, std::span<const MapTie> ties) : ties_(ties) {
    for (const MapStore* store : maps) {
      own_.push_back(own_map(*store));
    }
    for (const MapTie& tie : ties) {
      counts_.push_back(tie.search.is_tied && !tie.edges.empty());
    }
  }

  JoinedMaps run() {
    std::vector<std::size_t> contradicted;
    for (;;) {
      JoinedMaps joined = joined_by_those_that_count();
      const std::optional<std::size_t> worst = worst_tie();
      if (!worst) {
        revoke_edges(joined.merged);
        joined.contradicted = std::move(contradicted);
        std::ranges::sort(joined.contradicted);
        return joined;
      }
      counts_[*worst] = false;
      contradicted.push_back(*worst);
    }
  }

 private:
  std::vector<Step> largest_group() const {
    std::vector<Step> largest;
    std::size_t most = 0;
    std::vector<bool> seen(own_.size(), false);
    for (std::size_t base = 0; base < own_.size(); ++base) {
      if (seen[base]) {
        continue;
      }
      std::vector<Step> group = reached_from(base, ties_, counts_);
      std::size_t keyframes = 0;
      for (const Step& step : group) {
        seen[step.map] = true;
        keyframes += own_[step.map].keyframes.size();
      }
      if (keyframes > most) {
        most = keyframes;
        largest = std::move(group);
      }
    }
    return largest;
  }

  JoinedMaps joined_by_those_that_count() {
    JoinedMaps joined;
    MergedMap& merged = joined.merged;
    edges_of_.assign(ties_.size(), {});
    part_of_.clear();
    std::vector<Isometry3d> T_first_part;
    for (const Step& step : largest_group()) {
      Isometry3d T_first_map = Isometry3d::Identity();
      if (step.tie) {
        const MapTie& tie = ties_[*step.tie];
        const Isometry3d T_one_other = place_of_other(tie, own_[tie.one], own_[tie.other]);
        T_first_map = step.map == tie.other
                          ? T_first_part[part_of_.at(tie.one)] * T_one_other
                          : T_first_part[part_of_.at(tie.other)] * T_one_other.inverse();
      }
      T_first_part.push_back(orthonormalized(T_first_map));
      append(merged, step.map, T_first_part.back());
    }
    for (std::size_t i = 0; i < ties_.size(); ++i) {
      merged.searches.push_back(search_of(i));
    }
    const LoopOptimum optimum = optimize_with_loops(merged.graph);
    chi2_.clear();
    for (const std::optional<EdgeResult>& edge : optimum.report.edges) {
      chi2_.push_back(edge ? edge->chi2 : 0.0);
    }
    if (optimum.report.termination != Termination::failed) {
      merged.graph.set_poses(optimum.poses);
    }
    return joined;
  }

  /// The map with its ties to those before it.
  void append(MergedMap& merged, std::size_t map, const Isometry3d& T_first_map) {
    const OwnMap& own = own_[map];
    PoseGraph& graph = merged.graph;
    const MergedPart part{.map = map,
                          .first = graph.nodes().empty() ? 0 : graph.nodes().back().id + 1,
                          .stored = own.keyframes};
    for (const PoseNode& node : own.graph.nodes()) {
      graph.add_node({.id = part.merged(node.id),
                      .T_map_node = orthonormalized(T_first_map * node.T_map_node)});
    }
    for (LevelledNode level : own.graph.levels()) {
      level.node = part.merged(level.node);
      graph.add_level(level);
    }
    for (PoseEdge edge : own.graph.edges()) {
      edge.from = part.merged(edge.from);
      edge.to = part.merged(edge.to);
      graph.add_edge(edge);
    }
    add_candidates(merged, own.candidates, part, part);
    part_of_[map] = merged.parts.size();
    merged.parts.push_back(part);
    for (std::size_t i = 0; i < ties_.size(); ++i) {
      const MapTie& tie = ties_[i];
      const std::size_t partner = tie.one == map ? tie.other : tie.one;
      if (!counts_[i] || (tie.one != map && tie.other != map) || !part_of_.contains(partner)) {
        continue;
      }
      const MergedPart& one = merged.parts[part_of_.at(tie.one)];
      const MergedPart& other = merged.parts[part_of_.at(tie.other)];
      for (PoseEdge edge : tie.edges) {
        edges_of_[i].push_back(graph.edges().size());
        edge.from = one.merged(edge.from);
        edge.to = other.merged(edge.to);
        graph.add_edge(edge);
      }
      add_candidates(merged, tie.candidates, one, other);
    }
  }

  static void add_candidates(MergedMap& merged, std::vector<LoopCandidate> candidates,
                             const MergedPart& from, const MergedPart& to) {
    for (LoopCandidate& candidate : candidates) {
      candidate.id = static_cast<int64_t>(merged.candidates.size()) + 1;
      candidate.from = from.merged(candidate.from);
      candidate.to = to.merged(candidate.to);
      merged.candidates.push_back(std::move(candidate));
    }
  }

  MergeSearch search_of(std::size_t tie) const {
    MergeSearch search = ties_[tie].search;
    search.in = {ties_[tie].one};
    search.map = ties_[tie].other;
    search.is_tied = counts_[tie];
    return search;
  }

  /// The tie that fits worst of those that do not fit.
  std::optional<std::size_t> worst_tie() const {
    std::optional<std::size_t> worst;
    double most = kLoopReview;
    for (std::size_t i = 0; i < ties_.size(); ++i) {
      std::vector<double> chi2;
      for (const std::size_t edge : edges_of_[i]) {
        chi2.push_back(chi2_[edge]);
      }
      if (!chi2.empty() && median(chi2) > most) {
        most = median(chi2);
        worst = i;
      }
    }
    return worst;
  }

  /// Edges of ties that do not fit where most of their tie do.
  void revoke_edges(MergedMap& merged) const {
    for (const std::vector<std::size_t>& tie : edges_of_) {
      for (const std::size_t i : tie) {
        if (chi2_[i] <= kLoopReview) {
          continue;
        }
        merged.graph.set_status(i, EdgeStatus::revoked);
        const PoseEdge& edge = merged.graph.edges()[i];
        for (LoopCandidate& candidate : merged.candidates) {
          if (candidate.from == edge.from && candidate.to == edge.to &&
              candidate.verdict == CandidateVerdict::accepted) {
            candidate.verdict = CandidateVerdict::revoked;
          }
        }
      }
    }
  }

  std::span<const MapTie> ties_;
  std::vector<OwnMap> own_;
  std::vector<bool> counts_;                        ///< by tie
  std::map<std::size_t, std::size_t> part_of_;      ///< by map
  std::vector<std::vector<std::size_t>> edges_of_;  ///< by tie, in the merged graph
  std::vector<double> chi2_;                        ///< by edge of the merged graph
};

}  // namespace

MapTie tie_between(const MergedMap& merged, std::size_t one, std::size_t other) {
  MapTie tie{.one = one, .other = other};
  for (const MergeSearch& search : merged.searches) {
    tie.search = search;  // the last is the one that counts
  }
  if (merged.parts.size() < 2) {
    return tie;
  }
  const MergedPart& first = merged.parts.front();
  const MergedPart& second = merged.parts.back();
  const auto stored = [&](NodeId node) {
    const MergedPart& part = node < second.first ? first : second;
    return part.stored.at(static_cast<std::size_t>(node - part.first));
  };
  for (PoseEdge edge : merged.graph.edges()) {
    if (edge.kind == EdgeKind::loop && edge.status == EdgeStatus::active &&
        edge.from < second.first && edge.to >= second.first) {
      edge.from = stored(edge.from);
      edge.to = stored(edge.to);
      tie.edges.push_back(edge);
    }
  }
  for (LoopCandidate candidate : merged.candidates) {
    if (candidate.from < second.first && candidate.to >= second.first) {
      candidate.from = stored(candidate.from);
      candidate.to = stored(candidate.to);
      tie.candidates.push_back(std::move(candidate));
    }
  }
  return tie;
}

JoinedMaps join_maps(std::span<const MapStore* const> maps, std::span<const MapTie> given) {
  std::vector<std::size_t> order(given.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {},
                    [&](std::size_t i) { return std::pair(given[i].one, given[i].other); });
  std::vector<MapTie> ties;
  for (const std::size_t i : order) {
    ties.push_back(given[i]);
  }
  JoinedMaps joined = Join(maps, ties).run();
  for (std::size_t& tie : joined.contradicted) {
    tie = order[tie];
  }
  std::ranges::sort(joined.contradicted);
  return joined;
}

}  // namespace adit
