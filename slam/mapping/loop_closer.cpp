// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/loop_closer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

#include "adit/slam/core/median.hpp"
#include "adit/slam/mapping/join_review.hpp"
#include "adit/slam/mapping/loop_optimization.hpp"
#include "adit/slam/mapping/submap_codec.hpp"

namespace adit {
namespace {

// Measured on the simulated office's odometry, over 20 to 40 edges (docs/theory/loops.md).
constexpr double kLumps = 4.0;
constexpr NodeId kQueue = 5;        // keyframes
constexpr NodeId kJoining = 30;     // keyframes, of loops that tie parts of the graph
constexpr double kLeastRms = 0.02;  // m, expected of alignments at the least
constexpr std::size_t kMostRefuted = 50;
// What position finds may have drifted: the voting tells how far.
constexpr double kNoGate = std::numeric_limits<double>::infinity();

LoopSearchSettings search_settings(const Config& config) {
  return {.max_distance = 0.5 * config.preprocess.c_max,
          .min_path = std::max(10.0, 5.0 * config.keyframe.delta_trans)};
}

/// Half of the submap's points are nearer to its origin, m.
double reach_of(const KeyframeSubmap& submap) {
  std::vector<double> ranges;
  ranges.reserve(submap.points.size());
  for (const SubmapPoint& point : submap.points) {
    ranges.push_back(point.position().norm());
  }
  return ranges.empty() ? 0.0 : median(std::move(ranges));
}

PoseEdge edge_of(const LoopHypothesis& loop) {
  return {.from = loop.from,
          .to = loop.to,
          .T_from_to = loop.T_from_to,
          .information = symmetric_inverse(loop.covariance),
          .kind = EdgeKind::loop};
}

LoopReason reason_of(LoopObjection objection) {
  return objection == LoopObjection::odometry ? LoopReason::against_odometry
         : objection == LoopObjection::loops  ? LoopReason::against_loops
         : objection == LoopObjection::places ? LoopReason::another_place
                                              : LoopReason::few_votes;
}

double figure_of(const LoopVote& vote) {
  return vote.objection == LoopObjection::odometry ? vote.odometry_chi2
         : vote.objection == LoopObjection::loops  ? vote.worst_chi2
                                                   : static_cast<double>(vote.voters);
}

/// Where a loop ties two parts of the graph, the later one moves to where the loop has it, as a
/// whole: an optimisation would not find there from far away.
void join_parts(PoseGraph& graph, const LoopHypothesis& loop) {
  const std::vector<std::size_t> part_of = connected_components(graph).component_of;
  const std::size_t from = graph.index_of(loop.from);
  const std::size_t to = graph.index_of(loop.to);
  if (part_of[from] == part_of[to]) {
    return;
  }
  const Eigen::Isometry3d T_joined_map =
      graph.nodes()[from].T_map_node * loop.T_from_to * graph.nodes()[to].T_map_node.inverse();
  std::vector<Eigen::Isometry3d> poses = poses_of(graph);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (part_of[i] == part_of[to]) {
      poses[i] = orthonormalized(T_joined_map * poses[i]);
    }
  }
  graph.set_poses(poses);
}

/// The last `most` of them.
std::vector<LoopHypothesis> loops_of(const auto& pending,
                                     std::size_t most = std::numeric_limits<std::size_t>::max()) {
  std::vector<LoopHypothesis> loops;
  for (std::size_t i = pending.size() - std::min(pending.size(), most); i < pending.size(); ++i) {
    loops.push_back(pending[i].loop);
  }
  return loops;
}

bool is_any_borne_out(const std::vector<PendingLoop>& found) {
  return std::ranges::any_of(found, [](const PendingLoop& one) {
    return one.record.verdict == CandidateVerdict::waiting && one.expected;
  });
}

}  // namespace

LoopCloser::LoopCloser(engine::Context& context, const Config& config, const MapStore& store,
                       const MapMemory& memory)
    : memory_(memory),
      submaps_(store, memory.submap_bytes),
      index_(context),
      search_(search_settings(config)),
      appearance_{.min_path = search_.min_path},
      voting_{.lumps = kLumps},
      verifier_(context, config) {}

std::optional<PlaceDescriptor> LoopCloser::describe(const KeyframeSubmap& submap,
                                                    const SurfaceCloud& cloud) {
  if (submap.vertical == Vertical::unknown) {
    ++report_.without_vertical;
    index_.add_unknown();
    return std::nullopt;
  }
  return index_.add(cloud, plan_cell(submap.r_submap));
}

PendingLoop LoopCloser::judged(const LoopPlace& place, NodeId newest,
                               const LoopVerification& verdict) {
  const int64_t id = next_id_++;
  const bool validated = verdict.reason == LoopReason::none;
  ++report_.candidates;
  report_.by_appearance += place.source == LoopSource::appearance ? 1U : 0U;
  if (!validated) {
    ++report_.refused[static_cast<std::size_t>(verdict.reason)];
  }
  return {.loop = {.id = id,
                   .from = place.node,
                   .to = newest,
                   .T_from_to = verdict.T_from_to,
                   .covariance = verdict.covariance,
                   .strong = verdict.strong,
                   .source = place.source},
          .record = {.id = id,
                     .from = place.node,
                     .to = newest,
                     .T_from_to = verdict.T_from_to,
                     .source = place.source,
                     .score = place.score,
                     .overlap = verdict.overlap,
                     .chi2 = verdict.chi2,
                     .verdict = validated ? CandidateVerdict::waiting : CandidateVerdict::rejected,
                     .reason = std::string(to_string(verdict.reason)),
                     .rms = verdict.rms,
                     .correction = verdict.correction,
                     .turn = verdict.turn,
                     .through = verdict.through,
                     .figure = verdict.figure},
          .expected = verdict.expected};
}

// The newest node may not be tied to the one before: the odometry has started anew with it.
void LoopCloser::note_gap(const PoseGraph& graph, const KeyframeSubmap& submap) {
  constexpr std::size_t kAsked = 10;  // keyframes, whose highest speed counts
  const Nanoseconds stamp = submap.sweeps.front().stamp;
  if (graph.nodes().size() > 1) {
    const NodeId newest = graph.nodes().back().id;
    const NodeId before = graph.nodes()[graph.nodes().size() - 2].id;
    const auto edges = graph.edges_of(newest);
    const auto way = std::ranges::find_if(edges, [&](std::size_t index) {
      return graph.edges()[index].from == before || graph.edges()[index].to == before;
    });
    if (way == edges.end()) {
      const auto last = std::span(speeds_).last(std::min(speeds_.size(), kAsked));
      gaps_.push_back(tracking_gap(newest, seconds(stamp - std::min(last_tracked_, last_stamp_)),
                                   last.empty() ? 0.0 : std::ranges::max(last)));
    } else if (stamp > last_stamp_) {
      speeds_.push_back(graph.edges()[*way].T_from_to.translation().norm() /
                        seconds(stamp - last_stamp_));
    }
  } else {
    last_tracked_ = stamp;
  }
  last_stamp_ = stamp;
  for (const SubmapSweep& sweep : submap.sweeps) {
    last_tracked_ = sweep.merged ? sweep.stamp : last_tracked_;
  }
}

std::vector<PendingLoop> LoopCloser::verified(std::span<const LoopPlace> places, NodeId newest,
                                              const KeyframeSubmap& submap,
                                              const SurfaceCloud& cloud) {
  if (places.empty()) {
    return {};
  }
  std::vector<std::shared_ptr<const KeyframeSubmap>> submaps;
  submaps.reserve(places.size());
  std::vector<LoopQuestion> questions;
  for (const LoopPlace& place : places) {
    submaps.push_back(submaps_.get(place.node));
    questions.push_back({.from = submaps.back().get(),
                         .T_from_to = place.T_node_newest,
                         .covariance = place.covariance,
                         .gate = place.source == LoopSource::position ? kNoGate : kExpectedGate});
  }
  const double expected = rms_.empty() ? kFirstRms : std::max(median(rms_), kLeastRms);
  const std::vector<LoopVerification> verdicts =
      verifier_.verify(submap, cloud, questions, expected);
  std::vector<PendingLoop> found;
  for (std::size_t i = 0; i < places.size(); ++i) {
    found.push_back(judged(places[i], newest, verdicts[i]));
  }
  return found;
}

// By appearance only where no place that was found by position is borne out, and those again: the
// gate may have refused them for drift that it does not know of.
std::vector<PendingLoop> LoopCloser::find(const PoseGraph& graph, const KeyframeSubmap& submap,
                                          const SurfaceCloud& cloud) {
  const auto start = std::chrono::steady_clock::now();
  const NodeId newest = graph.nodes().back().id;
  note_gap(graph, submap);
  reaches_.push_back(reach_of(submap));
  if (!memory_.can_optimize(graph.nodes().size())) {
    return {};
  }
  const auto known = relative_places(graph, newest, voting_.lumps);
  const std::vector<LoopPlace> places = find_loop_places(graph, newest, known, reaches_, search_);
  std::vector<PendingLoop> found = verified(places, newest, submap, cloud);
  if (is_any_borne_out(found)) {
    pauses_.reset();
  } else if (pauses_.is_due()) {
    std::vector<LoopPlace> similar = find_similar_places(graph, index_, known, appearance_);
    std::erase_if(similar, [&](const LoopPlace& place) {
      return std::ranges::any_of(found, [&](const PendingLoop& one) {
        return one.loop.from == place.node && one.record.verdict == CandidateVerdict::waiting;
      });
    });
    std::vector<PendingLoop> alike = verified(similar, newest, submap, cloud);
    if (alike.empty() || is_any_borne_out(alike)) {
      pauses_.reset();
    } else {
      pauses_.refused();
    }
    std::ranges::move(alike, std::back_inserter(found));
  }
  for (PendingLoop& one : found) {
    const auto& way = known[graph.index_of(one.loop.from)];
    one.loop.without_heading = way && std::sqrt(way->covariance(5, 5)) > voting_.heading_sigma;
  }
  report_.search_ms.push_back(
      std::chrono::duration<float, std::milli>(std::chrono::steady_clock::now() - start).count());
  return found;
}

LoopCloser::Change LoopCloser::take_effect(PoseGraph& graph, NodeId keyframe,
                                           std::vector<PendingLoop> found) {
  Change change;
  for (PendingLoop& pending : found) {
    if (pending.record.verdict == CandidateVerdict::waiting) {
      queue_.push_back(std::move(pending));
    } else {
      change.records.push_back(std::move(pending.record));
    }
  }
  settle(graph, keyframe - kQueue + 1, change);
  return change;
}

LoopCloser::Change LoopCloser::finish(PoseGraph& graph) {
  Change change;
  while (!queue_.empty() || !joining_.empty()) {
    settle(graph, queue_.empty() ? joining_.front().loop.to + kJoining : queue_.front().loop.to,
           change);
  }
  for (const PendingLoop& one : accepted_) {
    change.records.push_back(one.record);  // with the last residual
  }
  return change;
}

// Loops that tie parts of the graph, or whose heading it does not know, wait longer, as they need
// more that speaks for them, and say nothing of the others. What others have tied meanwhile is a
// loop like any other.
void LoopCloser::sort_by_parts(const PoseGraph& graph) {
  if (joining_.empty() && queue_.empty()) {
    return;
  }
  const std::vector<std::size_t> part_of = connected_components(graph).component_of;
  std::vector<PendingLoop> all;
  std::ranges::move(queue_, std::back_inserter(all));
  std::ranges::move(joining_, std::back_inserter(all));
  std::ranges::stable_sort(all, {}, [](const PendingLoop& one) { return one.loop.to; });
  queue_.clear();
  joining_.clear();
  for (PendingLoop& one : all) {
    const bool is_tied =
        part_of[graph.index_of(one.loop.from)] == part_of[graph.index_of(one.loop.to)];
    (is_tied && !one.loop.without_heading ? queue_ : joining_).push_back(std::move(one));
  }
}

// The queues vote; then what is as old as `oldest` leaves them.
void LoopCloser::settle(PoseGraph& graph, NodeId oldest, Change& change) {
  while (true) {
    sort_by_parts(graph);
    std::vector<int64_t> accepted;
    if (!queue_.empty()) {
      accepted = let_in(graph, queue_, queue_.front().loop.to <= oldest, change);
    }
    if (accepted.empty() && !joining_.empty()) {
      accepted = let_in(graph, joining_, false, change);
    }
    if (accepted.empty()) {
      break;
    }
    optimize_and_review(graph, accepted, change);
  }
  leave(graph, queue_, oldest, change);
  leave(graph, joining_, oldest - kJoining + kQueue, change);
  review_joins(graph, change);
}

// What was refused may be right, and the join of two parts wrong that it contradicts: where it
// would have joined them itself, the join is taken back, and what is found from now on decides.
void LoopCloser::review_joins(PoseGraph& graph, Change& change) {
  if (opposing_.size() < voting_.least_unexpected || opposing_.back().id == reviewed_) {
    return;
  }
  reviewed_ = opposing_.back().id;
  const std::vector<LoopHypothesis> opposing(opposing_.begin(), opposing_.end());
  for (const TrackingGap& gap : gaps_) {
    const auto crossing = [&](const LoopHypothesis& one) {
      return crosses(graph, gap, one.from, one.to);
    };
    const std::size_t agreeing =
        agreeing_on_another_join(graph, gap, opposing, loops_of(accepted_), gaps_, voting_);
    if (agreeing == 0) {
      continue;
    }
    for (std::size_t i = 0; i < graph.edges().size(); ++i) {
      const PoseEdge& edge = graph.edges()[i];
      if (edge.kind == EdgeKind::loop && edge.status == EdgeStatus::active &&
          crosses(graph, gap, edge.from, edge.to)) {
        graph.set_status(i, EdgeStatus::revoked);
        change.revoked.push_back(i);
      }
    }
    for (PendingLoop& one : accepted_) {
      if (crossing(one.loop)) {
        take_back(one, LoopReason::another_place, static_cast<double>(agreeing), change);
      }
    }
    std::erase_if(accepted_, [](const PendingLoop& one) {
      return one.record.verdict == CandidateVerdict::revoked;
    });
    std::erase_if(refuted_, crossing);
    std::erase_if(opposing_, crossing);
  }
}

void LoopCloser::leave(const PoseGraph& graph, std::deque<PendingLoop>& queue, NodeId oldest,
                       Change& change) {
  while (!queue.empty() && queue.front().loop.to <= oldest) {
    const std::vector<LoopHypothesis> waiting = loops_of(queue);
    const std::vector<LoopHypothesis> accepted = loops_of(accepted_, voting_.most_asked);
    const LoopVote vote_ =
        vote(graph, waiting, {accepted, refuted_, gaps_, climb_, far_off_}, false, voting_).front();
    // What position has found is nearly where the graph has it: it may be right, and merely tilted.
    if (vote_.unexpected && vote_.objection == LoopObjection::odometry &&
        queue.front().loop.source == LoopSource::appearance) {
      refuted_.push_back(queue.front().loop);
      refuted_.erase(refuted_.begin(), refuted_.end() - static_cast<std::ptrdiff_t>(std::min(
                                                            refuted_.size(), kMostRefuted)));
    }
    const LoopHypothesis& loop = queue.front().loop;
    if (vote_.objection != LoopObjection::voters &&
        std::ranges::any_of(gaps_, [&](const TrackingGap& gap) {
          return crosses(graph, gap, loop.from, loop.to);
        })) {
      opposing_.push_back(loop);
      while (opposing_.front().to <= loop.to - kJoining) {
        opposing_.pop_front();
      }
    }
    refuse(queue.front(), reason_of(vote_.objection), figure_of(vote_), change);
    queue.pop_front();
  }
}

void LoopCloser::refuse(PendingLoop& pending, LoopReason reason, double figure, Change& change) {
  pending.record.verdict = CandidateVerdict::rejected;
  pending.record.reason = to_string(reason);
  pending.record.figure = figure;
  ++report_.refused[static_cast<std::size_t>(reason)];
  change.records.push_back(pending.record);
}

void LoopCloser::take_back(PendingLoop& accepted, LoopReason reason, double figure,
                           Change& change) {
  refuse(accepted, reason, figure, change);
  accepted.record.verdict = change.records.back().verdict = CandidateVerdict::revoked;
  report_.accepted_by_appearance -= accepted.loop.source == LoopSource::appearance ? 1U : 0U;
  --report_.accepted;
}

std::vector<int64_t> LoopCloser::let_in(PoseGraph& graph, std::deque<PendingLoop>& queue,
                                        bool last_chance, Change& change) {
  const std::vector<LoopHypothesis> waiting = loops_of(queue);
  const std::vector<LoopHypothesis> before = loops_of(accepted_, voting_.most_asked);
  const std::vector<LoopVote> votes =
      vote(graph, waiting, {before, refuted_, gaps_, climb_, far_off_}, last_chance, voting_);
  for (std::size_t i = 0; i < votes.size(); ++i) {
    const LoopHypothesis& loop = waiting[i];
    if (votes[i].accepted) {
      far_off_ = far_off_ || votes[i].odometry_chi2 > voting_.most_by_position;
      if (const auto shown = climb_of_odometry(graph, loop.from, loop.to, loop.T_from_to)) {
        climb_.add(*shown);
      }
    }
  }
  std::deque<PendingLoop> rest;
  std::vector<int64_t> accepted;
  for (std::size_t i = 0; i < votes.size(); ++i) {
    PendingLoop& pending = queue[i];
    if (!votes[i].accepted) {
      rest.push_back(std::move(pending));
      continue;
    }
    accepted.push_back(pending.loop.id);
    pending.record.verdict = CandidateVerdict::accepted;
    pending.record.figure = static_cast<double>(votes[i].voters);
    change.edges.push_back(edge_of(pending.loop));
    join_parts(graph, pending.loop);
    graph.add_edge(change.edges.back());
    report_.accepted_by_appearance += pending.loop.source == LoopSource::appearance ? 1U : 0U;
    accepted_.push_back(std::move(pending));
    ++report_.accepted;
  }
  queue = std::move(rest);
  return accepted;
}

// Until what is left fits: each round takes back what does not.
void LoopCloser::optimize_and_review(PoseGraph& graph, std::span<const int64_t> let_in,
                                     Change& change) {
  bool again = true;
  while (again) {
    again = false;
    const OptimizedGraph optimized = optimize_with_loops(graph);
    ++report_.optimizations;
    const NodeId newest = accepted_.empty() ? graph.nodes().front().id : accepted_.back().loop.to;
    const std::size_t at = graph.index_of(newest);
    report_.largest_correction = std::max(
        report_.largest_correction,
        (optimized.poses[at].translation() - graph.nodes()[at].T_map_node.translation()).norm());
    graph.set_poses(optimized.poses);
    graph.set_T_world_map(optimized.T_world_map);
    change.moved = true;
    std::map<std::pair<NodeId, NodeId>, PendingLoop*> owners;
    for (PendingLoop& one : accepted_) {
      owners.emplace(std::pair(one.loop.from, one.loop.to), &one);
    }
    for (std::size_t i = 0; i < graph.edges().size(); ++i) {
      const PoseEdge& edge = graph.edges()[i];
      const std::optional<EdgeResult>& result = optimized.report.edges[i];
      if (edge.kind != EdgeKind::loop || !result) {
        continue;
      }
      const auto owner = owners.find({edge.from, edge.to});
      if (owner == owners.end()) {
        continue;
      }
      PendingLoop& loop = *owner->second;
      loop.record.chi2 = result->chi2;
      if (result->chi2 > kLoopReview) {
        graph.set_status(i, EdgeStatus::revoked);
        change.revoked.push_back(i);
        take_back(loop, LoopReason::review, result->chi2, change);
        again = true;
      }
    }
    std::erase_if(accepted_, [](const PendingLoop& one) {
      return one.record.verdict == CandidateVerdict::revoked;
    });
  }
  for (const PendingLoop& one : accepted_) {
    if (std::ranges::find(let_in, one.loop.id) != let_in.end()) {
      change.records.push_back(one.record);
    }
  }
}

}  // namespace adit
