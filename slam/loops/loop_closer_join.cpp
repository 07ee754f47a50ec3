// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// A session is tied to the map of earlier ones only if it cannot as well be at another place, which
// looks the same.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "adit/slam/loops/join_review.hpp"
#include "adit/slam/loops/loop_closer.hpp"
#include "adit/slam/submaps/submap_codec.hpp"

namespace adit {
namespace {

constexpr double kBeside = 3.0;             // m, horizontally, between keyframes that see the same
constexpr double kSameFloor = 1.5;          // m, vertically
constexpr std::size_t kMostHypotheses = 4;  // of waiting loops, for the place of the session
constexpr double kOtherPlace = 2.0;         // m
constexpr double kOtherTurn = 0.5;          // rad
constexpr std::size_t kMostBeside = 3;      // keyframes of the map that are compared with one
constexpr double kLeastApart = 2.0;         // m, between keyframes that say something of their own
constexpr std::size_t kMostAsked = 60;      // keyframes of the session, the latest

// Standard deviations of a pose that a hypothesis predicts: m, rad.
Matrix6d hypothesis_covariance() {
  Vector6d sigma;
  sigma << 0.5, 0.5, 0.5, 0.02, 0.02, 0.05;
  return sigma.cwiseAbs2().asDiagonal();
}

// Share of the places that look the same where even the details are the same.
constexpr double kEqual = 0.3;
// Least log likelihood ratio of a single keyframe: something may have been moved.
constexpr double kLeastOfOne = -2.0;
// Nine in ten right places look alike in the verification, of twins perhaps seven: log(0.9 / 0.7)
// and log(0.1 / 0.3).
constexpr double kAlike = 0.25;
constexpr double kDifferent = -1.1;
constexpr double kClearLogOdds = 4.6;  // 100 to 1
// Nine in ten sessions begin in what is mapped.
constexpr double kMapped = 2.2;
// Of places that look the same, one in a hundred lies where the fixes of both maps have this one:
// an assumption, since fixes know some metres and maps are some hundred wide (decision 0040).
constexpr double kWithinFixes = 4.6;

using Kind = PlaceLikeness::Kind;

/// Log likelihood ratio of a place being the right one against one that only looks the same. Shares
/// that are seen through have exponential distributions; some places that look the same are as good
/// as the right one. A place that is not mapped says nothing.
double log_likelihood_ratio(const PlaceLikeness& place, const ThroughShares& through) {
  if (place.kind == Kind::not_mapped) {
    return 0.0;
  }
  if (place.kind == Kind::different) {
    return kDifferent;
  }
  if (!place.through) {
    return kAlike;
  }
  const auto density = [&](double mean) { return std::exp(-*place.through / mean) / mean; };
  const double right = density(through.right);
  const double alike = kEqual * right + (1.0 - kEqual) * density(through.alike);
  return std::max(std::log(right / alike), kLeastOfOne);
}

/// Shares that loops across a gap see through: of each later keyframe the loop with most overlap,
/// of keyframes so far apart that they say something of their own.
std::vector<double> through_across(const PoseGraph& graph, const TrackingGap& gap,
                                   std::span<const PendingLoop> accepted) {
  std::map<NodeId, const LoopCandidate*> best;
  for (const PendingLoop& one : accepted) {
    if (crosses(graph, gap, one.loop.from, one.loop.to)) {
      const auto [known, is_new] = best.emplace(one.loop.to, &one.record);
      if (!is_new && one.record.overlap > known->second->overlap) {
        known->second = &one.record;
      }
    }
  }
  std::vector<double> through;
  std::optional<Eigen::Vector3d> last;
  for (const auto& [node, loop] : best) {
    const Eigen::Vector3d at = graph.nodes()[graph.index_of(node)].T_map_node.translation();
    if (!last || (at - *last).norm() >= kLeastApart) {
      through.push_back(loop->through);
      last = at;
    }
  }
  return through;
}

}  // namespace

// Nothing ties the newest node to the map of earlier sessions.
bool LoopCloser::is_apart_from_map(std::span<const std::optional<RelativePlace>> known) const {
  const auto earlier = known.first(search_.earlier_nodes);
  return !earlier.empty() &&
         std::ranges::none_of(earlier, [](const auto& one) { return one.has_value(); });
}

// Waiting loops predict where the newest node is: the nearest node of the map to each predicted
// place, the latest loops first.
std::vector<LoopPlace> LoopCloser::predicted_places(const PoseGraph& graph, NodeId of) const {
  const std::vector<std::size_t> part_of = connected_components(graph).component_of;
  const std::size_t self = graph.index_of(of);
  const PoseNode& newest = graph.nodes()[self];
  std::vector<LoopPlace> places;
  for (auto pending = joining_.rbegin(); pending != joining_.rend(); ++pending) {
    const LoopHypothesis& loop = pending->loop;
    const std::size_t to = graph.index_of(loop.to);
    if (places.size() == kMostHypotheses || graph.index_of(loop.from) >= search_.earlier_nodes ||
        part_of[to] != part_of[self]) {
      continue;
    }
    const Eigen::Isometry3d T_map_newest = map_from_part(graph, loop) * newest.T_map_node;
    const std::vector<std::size_t> beside = nodes_beside(graph, T_map_newest);
    if (beside.empty() || std::ranges::any_of(places, [&](const LoopPlace& place) {
          return place.node == graph.nodes()[beside.front()].id;
        })) {
      continue;
    }
    const PoseNode& node = graph.nodes()[beside.front()];
    const Eigen::Isometry3d T_node_newest = node.T_map_node.inverse() * T_map_newest;
    places.push_back({.node = node.id,
                      .source = LoopSource::appearance,
                      .T_node_newest = T_node_newest,
                      .covariance = hypothesis_covariance(),
                      .distance = T_node_newest.translation().norm()});
  }
  return places;
}

// Nodes of the map that see the same as one at that place would, the nearest first.
std::vector<std::size_t> LoopCloser::nodes_beside(const PoseGraph& graph,
                                                  const Eigen::Isometry3d& T_map_place) const {
  std::vector<std::pair<double, std::size_t>> beside;  // distance, index
  for (std::size_t i = 0; i < search_.earlier_nodes; ++i) {
    const Eigen::Vector3d way =
        T_map_place.translation() - graph.nodes()[i].T_map_node.translation();
    if (way.head<2>().norm() <= kBeside && std::abs(way.z()) <= kSameFloor) {
      beside.emplace_back(way.norm(), i);
    }
  }
  std::ranges::sort(beside);
  std::vector<std::size_t> nodes;
  for (std::size_t k = 0; k < std::min(beside.size(), kMostBeside); ++k) {
    nodes.push_back(beside[k].second);
  }
  return nodes;
}

// The session's nodes that were searched for and are tied to `node`, latest first, so far apart
// that their submaps are independent evidence: at most `most`.
std::vector<std::size_t> LoopCloser::asked_nodes(const PoseGraph& graph, NodeId node,
                                                 std::size_t most) const {
  const std::size_t tied = graph.index_of(node);
  const std::vector<std::size_t> part_of = connected_components(graph).component_of;
  std::vector<std::size_t> asked;
  for (std::size_t i = reaches_.size(); i-- > search_.earlier_nodes;) {
    const Eigen::Vector3d at = graph.nodes()[i].T_map_node.translation();
    const double apart = std::max(kLeastApart, 0.5 * reaches_[i]);
    if (part_of[i] == part_of[tied] && asked.size() < most &&
        (asked.empty() ||
         (graph.nodes()[asked.back()].T_map_node.translation() - at).norm() >= apart)) {
      asked.push_back(i);
    }
  }
  return asked;
}

PlaceLikeness LoopCloser::likeness_at(const PoseGraph& graph, std::size_t node,
                                      const Eigen::Isometry3d& T_map_node) {
  const Eigen::Vector3d at = T_map_node.translation();
  const auto place = std::tuple(graph.nodes()[node].id, std::lround(at.x()), std::lround(at.y()),
                                std::lround(at.z()));
  auto known = likeness_.find(place);
  if (known == likeness_.end()) {
    known = likeness_.emplace(place, compared(graph, node, T_map_node)).first;
  }
  return known->second;
}

PlaceLikeness LoopCloser::compared(const PoseGraph& graph, std::size_t node,
                                   const Eigen::Isometry3d& T_map_node) {
  const std::vector<std::size_t> beside = nodes_beside(graph, T_map_node);
  if (beside.empty()) {
    return {};
  }
  const auto submap = submaps_.get(graph.nodes()[node].id);
  const SurfaceCloud cloud = make_surface_cloud(*context_, *submap);
  std::vector<std::shared_ptr<const KeyframeSubmap>> earlier;
  std::vector<LoopQuestion> questions;
  for (const std::size_t i : beside) {
    earlier.push_back(submaps_.get(graph.nodes()[i].id));
    questions.push_back({.from = earlier.back().get(),
                         .T_from_to = graph.nodes()[i].T_map_node.inverse() * T_map_node,
                         .covariance = hypothesis_covariance()});
  }
  PlaceLikeness likeness{.kind = Kind::different};
  for (const LoopVerification& found :
       verifier_.verify(*submap, cloud, questions, usual_rms(rms_))) {
    const bool seen = found.reason == LoopReason::none;
    if (seen || found.reason == LoopReason::degenerate || found.reason == LoopReason::ambiguous) {
      likeness.kind = Kind::alike;
    }
    if (seen) {
      likeness.through = std::min(likeness.through.value_or(1.0), found.through);
    }
  }
  return likeness;
}

// Where a loop to the map has the part of the graph that its later keyframe belongs to.
Eigen::Isometry3d LoopCloser::map_from_part(const PoseGraph& graph, const LoopHypothesis& loop) {
  return graph.nodes()[graph.index_of(loop.from)].T_map_node * loop.T_from_to *
         graph.nodes()[graph.index_of(loop.to)].T_map_node.inverse();
}

// A pose of the part that a loop claims, where no known one is nearly the same. `to`: a node of the
// part, at which they are compared.
void LoopCloser::add_hypothesis(const PoseGraph& graph, const LoopHypothesis& loop, std::size_t to,
                                std::vector<Eigen::Isometry3d>& known) const {
  const Eigen::Isometry3d& T_part_node = graph.nodes()[to].T_map_node;
  const Eigen::Isometry3d T_map_part = map_from_part(graph, loop);
  const bool is_new = std::ranges::none_of(known, [&](const Eigen::Isometry3d& one) {
    const Eigen::Isometry3d apart = (one * T_part_node).inverse() * T_map_part * T_part_node;
    return apart.translation().norm() < kOtherPlace && rotation_angle(apart.linear()) < kOtherTurn;
  });
  if (is_new && known.size() <= kMostHypotheses) {
    known.push_back(T_map_part);
  }
}

// Other poses of the part, by waiting loops, the latest first.
std::vector<Eigen::Isometry3d> LoopCloser::competing_hypotheses(const PoseGraph& graph,
                                                                const LoopHypothesis& loop) const {
  const std::vector<std::size_t> part_of = connected_components(graph).component_of;
  const std::size_t to = graph.index_of(loop.to);
  std::vector<Eigen::Isometry3d> known = {map_from_part(graph, loop)};
  for (auto pending = joining_.rbegin(); pending != joining_.rend(); ++pending) {
    const LoopHypothesis& other = pending->loop;
    if (graph.index_of(other.from) < search_.earlier_nodes &&
        part_of[graph.index_of(other.to)] == part_of[to]) {
      add_hypothesis(graph, other, to, known);
    }
  }
  known.erase(known.begin());
  return known;
}

// The log odds of a pose of the part against the likeliest one that looks like it: one that the map
// has, or one that it does not have.
double LoopCloser::least_log_odds(const PoseGraph& graph, const Eigen::Isometry3d& T_map_part,
                                  std::span<const std::size_t> asked,
                                  std::span<const Eigen::Isometry3d> hypotheses) {
  const ThroughShares& usual = aliases_.through;
  using Place = std::function<Eigen::Isometry3d(const Eigen::Isometry3d& T_part_node)>;
  const auto sum_of = [&](const ThroughShares& through, const Place& other) {
    double sum = 0.0;
    bool is_mapped = static_cast<bool>(other);
    for (const std::size_t i : asked) {
      const Eigen::Isometry3d& T_part_node = graph.nodes()[i].T_map_node;
      sum += log_likelihood_ratio(likeness_at(graph, i, T_map_part * T_part_node), through);
      if (other) {
        const PlaceLikeness there = likeness_at(graph, i, other(T_part_node));
        sum -= log_likelihood_ratio(there, through);
        is_mapped = is_mapped && there.kind != PlaceLikeness::Kind::not_mapped;
      }
    }
    return is_mapped ? sum : sum + kMapped;
  };
  double least = same_site_ ? std::numeric_limits<double>::infinity() : sum_of(usual, {});
  const auto against = [&](const MapAlias& alias, const Place& other) {
    least = std::min(least, sum_of({.right = usual.right, .alike = alias.mean_through()}, other));
  };
  for (const MapAlias& alias : aliases_.all) {
    against(alias, [&](const Eigen::Isometry3d& T_part_node) {
      return alias.moved(T_map_part * T_part_node);
    });
  }
  for (const MapAlias& alias : own_aliases_.all) {
    against(alias, [&](const Eigen::Isometry3d& T_part_node) {
      return Eigen::Isometry3d(T_map_part * alias.moved(T_part_node));
    });
  }
  for (const Eigen::Isometry3d& T_other_part : hypotheses) {
    least = std::min(least, sum_of(usual, [&](const Eigen::Isometry3d& T_part_node) {
                       return Eigen::Isometry3d(T_other_part * T_part_node);
                     }));
  }
  return least;
}

// The log odds of the place where the fixes of both maps have the later one. Things that one sees
// through may have been moved: it counts whether places look the same, and most of them do not at a
// place that is wrong.
double LoopCloser::expected_log_odds(const PoseGraph& graph, std::span<const std::size_t> asked) {
  double sum = kMapped + kWithinFixes;
  for (const std::size_t i : asked) {
    const Kind kind = likeness_at(graph, i, graph.nodes()[i].T_map_node).kind;
    sum += kind == Kind::alike ? kAlike : kind == Kind::different ? kDifferent : 0.0;
  }
  return sum;
}

// Nodes of the later map where the earlier one has their places, at most kMostAsked of them, spread
// over all of it.
std::vector<std::size_t> LoopCloser::confirming_nodes(const PoseGraph& graph, NodeId tied) const {
  std::vector<std::size_t> mapped;
  for (const std::size_t i : asked_nodes(graph, tied, reaches_.size())) {
    if (!nodes_beside(graph, graph.nodes()[i].T_map_node).empty()) {
      mapped.push_back(i);
    }
  }
  std::vector<std::size_t> spread;
  const std::size_t count = std::min(mapped.size(), kMostAsked);
  for (std::size_t k = 0; k < count; ++k) {
    spread.push_back(mapped[k * mapped.size() / count]);
  }
  return spread;
}

LoopCloser::Change LoopCloser::confirm_join(PoseGraph& graph) {
  Change change;
  const auto one = std::ranges::find_if(accepted_, [&](const PendingLoop& loop) {
    return crosses(graph, gaps_.front(), loop.loop.from, loop.loop.to);
  });
  if (one == accepted_.end()) {
    return change;
  }
  const std::vector<std::size_t> asked = confirming_nodes(graph, one->loop.to);
  std::vector<Eigen::Isometry3d> hypotheses = {Eigen::Isometry3d::Identity()};
  for (auto other = opposing_.rbegin(); other != opposing_.rend(); ++other) {
    add_hypothesis(graph, *other, graph.index_of(one->loop.to), hypotheses);
  }
  const bool is_expected = expects_start(graph);
  const double odds = is_expected ? expected_log_odds(graph, asked)
                                  : least_log_odds(graph, Eigen::Isometry3d::Identity(), asked,
                                                   std::span(hypotheses).subspan(1));
  best_log_odds_ = odds;
  built_alike_log_odds_ =
      is_expected || same_site_
          ? std::nullopt
          : std::optional(kMapped +
                          log_ratio_to_built_alike(through_across(graph, gaps_.front(), accepted_),
                                                   aliases_.through));
  if (odds < kClearLogOdds || is_built_alike()) {
    undo_join(graph, gaps_.front(), odds, change);
  }
  return change;
}

// Votes that tie the session to the map count only if their place is clearly the likeliest. True:
// another place is clearly likelier, and the loops have left the queue.
bool LoopCloser::refuse_ambiguous_joins(const PoseGraph& graph, std::vector<LoopVote>& votes,
                                        Change& change) {
  const auto joins_map = [&](std::size_t i) {
    return votes[i].accepted && graph.index_of(joining_[i].loop.from) < search_.earlier_nodes &&
           graph.index_of(joining_[i].loop.to) >= search_.earlier_nodes;
  };
  std::size_t first = 0;
  while (first < votes.size() && !joins_map(first)) {
    ++first;
  }
  if (first == votes.size()) {
    return false;
  }
  const LoopHypothesis& loop = joining_[first].loop;
  const double odds =
      least_log_odds(graph, map_from_part(graph, loop), asked_nodes(graph, loop.to, kMostAsked),
                     competing_hypotheses(graph, loop));
  best_log_odds_ = std::max(best_log_odds_.value_or(odds), odds);
  ambiguous_ = odds < kClearLogOdds;
  if (!ambiguous_) {
    return false;
  }
  const bool is_wrong = odds < -kClearLogOdds;
  std::deque<PendingLoop> rest;
  for (std::size_t i = 0; i < votes.size(); ++i) {
    if (votes[i].accepted && is_wrong) {
      refuse(joining_[i], LoopReason::another_place, static_cast<double>(votes[i].voters), change);
      continue;
    }
    votes[i].objection = votes[i].accepted ? LoopObjection::places : votes[i].objection;
    votes[i].accepted = false;
    rest.push_back(std::move(joining_[i]));
  }
  joining_ = std::move(rest);
  return is_wrong;
}

}  // namespace adit
