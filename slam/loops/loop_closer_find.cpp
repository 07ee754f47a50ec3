// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The closer's search: candidates of a keyframe, and what verification makes of them.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "adit/slam/core/median.hpp"
#include "adit/slam/loops/loop_closer.hpp"
#include "adit/slam/submaps/submap_codec.hpp"

namespace adit {
namespace {

constexpr double kFirstRms = 0.05;  // m, expected of alignments where none has shown it yet
constexpr double kLeastRms = 0.02;  // m, and at the least
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

bool is_any_borne_out(const std::vector<PendingLoop>& found) {
  return std::ranges::any_of(found, [](const PendingLoop& one) {
    return one.record.verdict == CandidateVerdict::waiting && one.expected;
  });
}

}  // namespace

double usual_rms(std::vector<double> consecutive) {
  return consecutive.empty() ? kFirstRms : std::max(median(std::move(consecutive)), kLeastRms);
}

LoopCloser::LoopCloser(engine::Context& context, const Config& config, SubmapLoader load,
                       const MapMemory& memory)
    : context_(&context),
      memory_(memory),
      submaps_(std::move(load), memory.submap_bytes),
      index_(context),
      search_(search_settings(config)),
      appearance_{.min_path = search_.min_path},
      searching_{.min_path = search_.min_path,
                 .least_similarity = 0.5,
                 .least_likeness = 0.5,
                 .most_correlated = 8,
                 .most = 4},
      verifier_(context, config) {}

// How far submaps of earlier sessions reach is not stored: as far as the newest one's.
void LoopCloser::begin_behind(std::span<const EarlierPlace> places, MapAliases aliases,
                              int64_t last_id) {
  aliases_ = std::move(aliases);
  std::vector<std::optional<PlaceDescriptor>> descriptors;
  descriptors.reserve(places.size());
  for (const EarlierPlace& place : places) {
    descriptors.push_back(place.descriptor);
    levelled_.push_back(place.levelled);
    reaches_.push_back(std::numeric_limits<double>::infinity());
  }
  index_.add_described(descriptors);
  search_.earlier_nodes = appearance_.earlier_nodes = searching_.earlier_nodes = places.size();
  next_id_ = last_id + 1;
}

// How far one map lies from the other nobody knows.
void LoopCloser::search_between(NodeId first, bool same_site) {
  same_site_ = same_site;
  constexpr double kAnywhere = std::numeric_limits<double>::infinity();
  search_.earlier_alone = appearance_.earlier_alone = searching_.earlier_alone = true;
  gaps_.push_back({.after = first, .reach = kAnywhere, .climb = kAnywhere});
}

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
  if (graph.nodes().size() > search_.earlier_nodes + 1) {
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
    if (search_.earlier_nodes > 0) {  // how far the sensor was brought meanwhile nobody knows
      constexpr double kAnywhere = std::numeric_limits<double>::infinity();
      gaps_.push_back({.after = graph.nodes().back().id, .reach = kAnywhere, .climb = kAnywhere});
    }
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
  const std::vector<LoopVerification> verdicts =
      verifier_.verify(submap, cloud, questions, usual_rms(rms_));
  std::vector<PendingLoop> found;
  for (std::size_t i = 0; i < places.size(); ++i) {
    found.push_back(judged(places[i], newest, verdicts[i]));
  }
  return found;
}

std::vector<PendingLoop> LoopCloser::find(const PoseGraph& graph, const KeyframeSubmap& submap,
                                          const SurfaceCloud& cloud) {
  note_gap(graph, submap);
  note(submap);
  return found_of(graph, graph.nodes().back().id, submap, cloud, true);
}

std::vector<PendingLoop> LoopCloser::find_between(const PoseGraph& graph, NodeId node,
                                                  const KeyframeSubmap& submap,
                                                  const SurfaceCloud& cloud) {
  const bool is_described = graph.index_of(node) + 1 == index_.size();
  std::vector<PendingLoop> found = found_of(graph, node, submap, cloud, is_described);
  std::erase_if(found, [&](const PendingLoop& one) {
    return std::ranges::any_of(accepted_, [&](const PendingLoop& known) {
      return known.loop.from == one.loop.from && known.loop.to == one.loop.to;
    });
  });
  return found;
}

void LoopCloser::note(const KeyframeSubmap& submap) {
  reaches_.push_back(reach_of(submap));
  levelled_.push_back(submap.vertical != Vertical::unknown);
}

// By appearance only where no place that was found by position is borne out, and those again: the
// gate may have refused them for drift that it does not know of.
std::vector<PendingLoop> LoopCloser::found_of(const PoseGraph& graph, NodeId node,
                                              const KeyframeSubmap& submap,
                                              const SurfaceCloud& cloud, bool is_described) {
  const auto start = std::chrono::steady_clock::now();
  if (!memory_.can_optimize(graph.nodes().size())) {
    return {};
  }
  const auto known = relative_places(graph, node, voting_.lumps);
  const std::vector<LoopPlace> places = find_loop_places(graph, node, known, reaches_, search_);
  std::vector<PendingLoop> found = verified(places, node, submap, cloud);
  const bool is_apart = is_apart_from_map(known);
  if (is_any_borne_out(found) && !is_apart) {
    pauses_.reset();
  } else if (is_described && (is_apart || pauses_.is_due())) {
    std::vector<LoopPlace> similar =
        find_similar_places(graph, index_, known, is_apart ? searching_ : appearance_);
    if (is_apart) {
      std::ranges::move(predicted_places(graph, node), std::back_inserter(similar));
    }
    std::erase_if(similar, [&](const LoopPlace& place) {
      return std::ranges::any_of(found, [&](const PendingLoop& one) {
        return one.loop.from == place.node && one.record.verdict == CandidateVerdict::waiting;
      });
    });
    std::vector<PendingLoop> alike = verified(similar, node, submap, cloud);
    if (alike.empty() || is_any_borne_out(alike)) {
      pauses_.reset();
    } else {
      pauses_.refused();
    }
    std::ranges::move(alike, std::back_inserter(found));
  }
  for (PendingLoop& one : found) {
    const std::size_t from = graph.index_of(one.loop.from);
    const auto& way = known[from];
    one.loop.levelled = levelled_[from] && levelled_[graph.index_of(node)];
    one.loop.without_heading = way && std::sqrt(way->covariance(5, 5)) > voting_.heading_sigma;
  }
  report_.search_ms.push_back(
      std::chrono::duration<float, std::milli>(std::chrono::steady_clock::now() - start).count());
  return found;
}

}  // namespace adit
