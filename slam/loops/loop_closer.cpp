// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/loops/loop_closer.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

#include "adit/slam/graph/loop_optimization.hpp"
#include "adit/slam/loops/join_review.hpp"

namespace adit {
namespace {

constexpr NodeId kQueue = 5;              // keyframes
constexpr std::size_t kMostWaiting = 10;  // of so many loops, one
constexpr NodeId kJoining = 30;           // keyframes, of loops that tie parts of the graph
constexpr std::size_t kMostRefuted = 50;

PoseEdge edge_of(const LoopHypothesis& loop) {
  return {.from = loop.from,
          .to = loop.to,
          .T_from_to = loop.T_from_to,
          .information = symmetric_inverse(loop.covariance),
          .kind = EdgeKind::loop};
}

std::size_t index_of_edge(const PoseGraph& graph, const LoopHypothesis& loop) {
  for (const std::size_t i : graph.edges_of(loop.to)) {
    const PoseEdge& edge = graph.edges()[i];
    if (edge.kind == EdgeKind::loop && edge.from == loop.from && edge.to == loop.to) {
      return i;
    }
  }
  throw std::logic_error("an accepted loop has no edge");
}

/// Chi squared against where the graph has its places, as if that were known.
double chi2_in(const PoseGraph& graph, const LoopHypothesis& loop) {
  const Eigen::Isometry3d T_from_to =
      graph.nodes()[graph.index_of(loop.from)].T_map_node.inverse() *
      graph.nodes()[graph.index_of(loop.to)].T_map_node;
  const Vector6d off = se3_log(loop.T_from_to.inverse() * T_from_to);
  return off.dot(symmetric_inverse(loop.covariance) * off);
}

void set_status(PoseGraph& graph, std::size_t edge, EdgeStatus status, LoopCloser::Change& change) {
  graph.set_status(edge, status);
  change.statuses.emplace_back(edge, status);
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
/// whole: an optimisation would not find there from far away. The part that the map begins with
/// stays.
void join_parts(PoseGraph& graph, const LoopHypothesis& loop) {
  const std::vector<std::size_t> part_of = connected_components(graph).component_of;
  const std::size_t from = graph.index_of(loop.from);
  const std::size_t to = graph.index_of(loop.to);
  if (part_of[from] == part_of[to]) {
    return;
  }
  Eigen::Isometry3d T_joined_map =
      graph.nodes()[from].T_map_node * loop.T_from_to * graph.nodes()[to].T_map_node.inverse();
  std::size_t moving = part_of[to];
  if (moving == part_of.front()) {
    T_joined_map = T_joined_map.inverse();
    moving = part_of[from];
  }
  std::vector<Eigen::Isometry3d> poses = poses_of(graph);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (part_of[i] == moving) {
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

}  // namespace

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
  if (waiting_ > 0) {
    optimize_and_review(graph, {}, change);
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

// The queues vote until nothing comes in and all that is as old as `oldest` has left them: what is
// left votes anew whenever a keyframe's loops leave.
void LoopCloser::settle(PoseGraph& graph, NodeId oldest, Change& change) {
  while (true) {
    sort_by_parts(graph);
    const bool is_due = !queue_.empty() && queue_.front().loop.to <= oldest;
    const bool is_join_due =
        !joining_.empty() && joining_.front().loop.to <= oldest - kJoining + kQueue;
    const std::vector<LoopVote> votes = voted(graph, queue_, is_due);
    if (let_in(graph, queue_, votes, change)) {
      continue;
    }
    std::vector<LoopVote> joins = voted(graph, joining_, false);
    if (refuse_ambiguous_joins(graph, joins, change)) {
      continue;
    }
    if (let_in(graph, joining_, joins, change)) {
      continue;
    }
    if (is_due) {
      leave(graph, queue_, votes, change);
    }
    if (is_join_due) {
      leave(graph, joining_, joins, change);
    }
    if (!is_due && !is_join_due) {
      break;
    }
  }
  if (!search_.earlier_alone) {  // which confirm_join() decides
    review_joins(graph, change);
  }
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
    const std::size_t agreeing =
        agreeing_on_another_join(graph, gap, opposing, loops_of(accepted_), gaps_, voting_);
    if (agreeing == 0) {
      continue;
    }
    undo_join(graph, gap, static_cast<double>(agreeing), change);
  }
}

// All loops across the gap are revoked, and the start that was expected there; what was found
// against them is forgotten.
void LoopCloser::undo_join(PoseGraph& graph, const TrackingGap& gap, double figure,
                           Change& change) {
  const auto crossing = [&](const LoopHypothesis& one) {
    return crosses(graph, gap, one.from, one.to);
  };
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    const PoseEdge& edge = graph.edges()[i];
    if (edge.kind != EdgeKind::odometry && edge.status == EdgeStatus::active &&
        crosses(graph, gap, edge.from, edge.to)) {
      set_status(graph, i, EdgeStatus::revoked, change);
    }
  }
  for (PendingLoop& one : accepted_) {
    if (crossing(one.loop)) {
      take_back(one, LoopReason::another_place, figure, change);
    }
  }
  forget_revoked();
  std::erase_if(doubted_, [&](const PendingLoop& one) { return crossing(one.loop); });
  std::erase_if(refuted_, crossing);
  std::erase_if(opposing_, crossing);
}

// All loops of the oldest keyframe leave the queue, as they have been voted on: one that disputes
// another one does not leave for the other to come in.
void LoopCloser::leave(const PoseGraph& graph, std::deque<PendingLoop>& queue,
                       std::span<const LoopVote> votes, Change& change) {
  const NodeId keyframe = queue.front().loop.to;
  for (const LoopVote& vote : votes) {
    const LoopHypothesis loop = queue.front().loop;
    if (loop.to != keyframe) {
      break;
    }
    // What position has found is nearly where the graph has it, and a tilt says nothing of drift:
    // it may be right, and merely tilted.
    if (vote.unexpected && vote.objection == LoopObjection::odometry &&
        loop.source == LoopSource::appearance && !is_tilted(loop.T_from_to)) {
      refuted_.push_back(loop);
      refuted_.erase(refuted_.begin(), refuted_.end() - static_cast<std::ptrdiff_t>(std::min(
                                                            refuted_.size(), kMostRefuted)));
    }
    if (vote.objection != LoopObjection::voters &&
        std::ranges::any_of(gaps_, [&](const TrackingGap& gap) {
          return crosses(graph, gap, loop.from, loop.to);
        })) {
      opposing_.push_back(loop);
      while (opposing_.front().to <= loop.to - kJoining) {
        opposing_.pop_front();
      }
    }
    refuse(queue.front(), reason_of(vote.objection), figure_of(vote), change);
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

/// Those that were taken back leave the accepted; what a review has taken back once is tried again.
void LoopCloser::forget_revoked() {
  for (const PendingLoop& one : accepted_) {
    if (one.record.verdict == CandidateVerdict::revoked && !one.tried_again &&
        one.record.reason == to_string(LoopReason::review)) {
      doubted_.push_back(one);
    }
  }
  std::erase_if(accepted_, [](const PendingLoop& one) {
    return one.record.verdict == CandidateVerdict::revoked;
  });
}

void LoopCloser::accept(PendingLoop pending, std::size_t votes) {
  pending.votes = votes;
  pending.record.verdict = CandidateVerdict::accepted;
  pending.record.reason = to_string(LoopReason::none);
  pending.record.figure = static_cast<double>(votes);
  report_.accepted_by_appearance += pending.loop.source == LoopSource::appearance ? 1U : 0U;
  ++report_.accepted;
  accepted_.push_back(std::move(pending));
}

std::vector<LoopVote> LoopCloser::voted(const PoseGraph& graph,
                                        const std::deque<PendingLoop>& queue,
                                        bool last_chance) const {
  if (queue.empty()) {
    return {};
  }
  const std::vector<LoopHypothesis> waiting = loops_of(queue);
  const std::vector<LoopHypothesis> before = loops_of(accepted_, voting_.most_asked);
  EarlierLoops earlier{.accepted = before,
                       .refuted = refuted_,
                       .gaps = gaps_,
                       .earlier_nodes = search_.earlier_nodes};
  for (const PendingLoop& one : accepted_) {
    if (one.shown) {
      earlier.drift.learn(*one.shown, 1.0 / static_cast<double>(one.together));
    }
  }
  return vote(graph, waiting, earlier, last_chance, voting_);
}

// Those that have won come in, and the graph is optimised. False: none has.
bool LoopCloser::let_in(PoseGraph& graph, std::deque<PendingLoop>& queue,
                        std::span<const LoopVote> votes, Change& change) {
  std::deque<PendingLoop> rest;
  std::vector<int64_t> accepted;
  // Of the path before they come in. What has come in earlier ties it, so that each shows what has
  // come to pass since.
  std::vector<std::optional<DriftDifference>> shown(votes.size());
  std::size_t together = 0;
  for (std::size_t i = 0; i < votes.size(); ++i) {
    if (votes[i].accepted) {
      shown[i] = shown_drift(graph, queue[i].loop, voting_);
      ++together;
    }
  }
  for (std::size_t i = 0; i < votes.size(); ++i) {
    PendingLoop& pending = queue[i];
    if (!votes[i].accepted) {
      rest.push_back(std::move(pending));
      continue;
    }
    const LoopHypothesis& loop = pending.loop;
    pending.shown = shown[i];
    pending.together = together;
    change.edges.push_back(edge_of(loop));
    join_parts(graph, loop);
    graph.add_edge(change.edges.back());
    accepted.push_back(loop.id);
    accept(std::move(pending), votes[i].voters);
  }
  queue = std::move(rest);
  if (accepted.empty()) {
    return false;
  }
  if (&queue == &joining_ || !may_wait(graph, accepted)) {
    optimize_and_review(graph, std::move(accepted), change);
    return true;
  }
  for (PendingLoop& one : accepted_) {
    if (std::ranges::find(accepted, one.loop.id) != accepted.end()) {
      one.record.chi2 = chi2_in(graph, one.loop);
      change.records.push_back(one.record);
    }
  }
  return true;
}

// Where the graph has the places of the newest loops, to within their covariances, an optimum moves
// little: one for each tenth more loops is enough, so that their number grows as the logarithm of
// the loops'.
bool LoopCloser::may_wait(const PoseGraph& graph, std::span<const int64_t> let_in) {
  waiting_ += let_in.size();
  return kMostWaiting * waiting_ < accepted_.size() &&
         std::ranges::all_of(accepted_, [&](const PendingLoop& one) {
           return std::ranges::find(let_in, one.loop.id) == let_in.end() ||
                  chi2_in(graph, one.loop) <= voting_.agreement;
         });
}

// Each round takes back what does not fit, until all that is left does; then what was taken back
// earlier and fits now is tried again.
void LoopCloser::optimize_and_review(PoseGraph& graph, std::vector<int64_t> let_in,
                                     Change& change) {
  do {
    while (review(graph, let_in, change)) {
    }
  } while (let_in_again(graph, let_in, change));
  for (const PendingLoop& one : accepted_) {
    if (std::ranges::find(let_in, one.loop.id) != let_in.end()) {
      change.records.push_back(one.record);
    }
  }
}

// Optimises and takes back what does not fit. False: nothing. Where it fails nothing is known of
// how loops fit: those that have come in since it did not are taken back.
bool LoopCloser::review(PoseGraph& graph, std::span<const int64_t> let_in, Change& change) {
  const OptimizedGraph optimized = optimize_with_loops(graph);
  ++report_.optimizations;
  waiting_ = 0;
  const bool failed = optimized.report.termination == Termination::failed;
  if (!failed) {
    note_correction(graph, optimized.poses);
    graph.set_poses(optimized.poses);
    graph.set_T_world_map(optimized.T_world_map);
    change.moved = true;
  }
  bool any = false;
  for (PendingLoop& one : accepted_) {
    const std::size_t edge = index_of_edge(graph, one.loop);
    const bool is_new = std::ranges::find(let_in, one.loop.id) != let_in.end();
    const std::optional<EdgeResult>& known = optimized.report.edges[edge];
    const EdgeResult* const result = !failed && known ? &*known : nullptr;
    one.record.chi2 = result != nullptr ? result->chi2 : one.record.chi2;
    if (failed ? is_new : result != nullptr && result->chi2 > kLoopReview) {
      set_status(graph, edge, EdgeStatus::revoked, change);
      take_back(one, LoopReason::review, failed ? 0.0 : result->chi2, change);
      any = true;
    }
  }
  forget_revoked();
  return any && !failed;
}

// True: some loops that were taken back are where the graph has their places now, and in it again.
bool LoopCloser::let_in_again(PoseGraph& graph, std::vector<int64_t>& let_in, Change& change) {
  const auto end = std::ranges::partition(doubted_, [&](const PendingLoop& one) {
    return chi2_in(graph, one.loop) > voting_.agreement;
  });
  for (PendingLoop& one : end) {
    set_status(graph, index_of_edge(graph, one.loop), EdgeStatus::active, change);
    --report_.refused[static_cast<std::size_t>(LoopReason::review)];
    let_in.push_back(one.loop.id);
    one.tried_again = true;
    const std::size_t votes = one.votes;
    accept(std::move(one), votes);
  }
  const bool any = !end.empty();
  doubted_.erase(end.begin(), end.end());
  return any;
}

void LoopCloser::note_correction(const PoseGraph& graph, std::span<const Eigen::Isometry3d> poses) {
  if (accepted_.empty()) {
    return;
  }
  const auto newest =
      std::ranges::max_element(accepted_, {}, [](const PendingLoop& one) { return one.loop.to; });
  const std::size_t at = graph.index_of(newest->loop.to);
  report_.largest_correction =
      std::max(report_.largest_correction,
               (poses[at].translation() - graph.nodes()[at].T_map_node.translation()).norm());
}

}  // namespace adit
