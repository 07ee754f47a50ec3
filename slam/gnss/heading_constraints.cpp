// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/gnss/heading_constraints.hpp"

#include <algorithm>
#include <cmath>

#include "adit/slam/core/units.hpp"
#include "adit/slam/gnss/first_part.hpp"
#include "adit/slam/gnss/gnss_noise.hpp"
#include "adit/slam/gnss/heading_consensus.hpp"

namespace adit {
namespace {

constexpr double kBestDeviation = 0.2 * kDegree;  // data sheets of antennas a metre apart
constexpr double kHeadingTime = 0.5;              // s, between headings that count, as of fixes
// By which a sensor turns before a source that repeats itself is frozen. Sources that state whole
// degrees repeat themselves at less.
constexpr double kFrozenTurn = 5.0 * kDegree;
// Of an axis's elevation: beyond 60 degrees an error of the tilt doubles in the heading.
constexpr double kLeastLevel = 0.5;
// Of the yaw that fixes alone give: what is known worse judges nothing.
constexpr double kRoughFixYaw = 10.0 * kDegree;

Eigen::Vector3d axis_in_map(const PoseGraph& graph, const MapHeading& heading) {
  return graph.nodes()[graph.index_of(heading.keyframe)].T_map_node.linear() *
         heading.axis_keyframe;
}

double yaw_of(const Eigen::Vector3d& axis) {
  return std::atan2(axis.y(), axis.x());
}

/// Between true north and the world's y axis where the heading was taken, clockwise, rad: what is
/// to be added to a yaw from true east.
double convergence_of(const PoseGraph& graph, const MapHeading& heading, const PlacedMap& place) {
  if (place.frame == nullptr) {
    return 0.0;
  }
  const PoseNode& node = graph.nodes()[graph.index_of(heading.keyframe)];
  return place.frame->convergence_at(place.T_world_map * node.T_map_node.translation());
}

bool can_agree(HeadingVerdict verdict) {
  return verdict == HeadingVerdict::waiting || verdict == HeadingVerdict::used ||
         verdict == HeadingVerdict::outlier || verdict == HeadingVerdict::apart ||
         verdict == HeadingVerdict::refused;
}

}  // namespace

// An axis that leans would measure tilts, too: a roll of a radian turns one that rises by 5 mrad as
// far as a heading's noise does, and before a map is levelled nothing else holds its roll.
MeasuredHeading as_measured(const MapHeading& heading, const PoseGraph& graph,
                            const WorldFrame& frame) {
  const PlacedMap place{.frame = &frame, .T_world_map = graph.T_world_map()};
  const PoseNode& node = graph.nodes()[graph.index_of(heading.keyframe)];
  const Eigen::Matrix3d R_world_node = graph.T_world_map().linear() * node.T_map_node.linear();
  Eigen::Vector3d level = R_world_node * heading.axis_keyframe;
  level.z() = 0.0;
  return {.node = heading.keyframe,
          .axis_node = R_world_node.transpose() * level.normalized(),
          .yaw = heading.yaw + convergence_of(graph, heading, place),
          .information = heading.information};
}

double heading_deviation(const Heading& heading, const GnssConfig& config) {
  return std::max(kBestDeviation, heading.sigma.value_or(config.heading_sigma));
}

void HeadingConstraints::add(std::span<const MapHeading> headings) {
  headings_.insert(headings_.end(), headings.begin(), headings.end());
  report_.headings = headings_.size();
  report_.verdicts[static_cast<std::size_t>(HeadingVerdict::waiting)] += headings.size();
  if (!headings_.empty() && report_.state == HeadingState::none) {
    report_.state = HeadingState::waiting;
  }
}

void HeadingConstraints::set_verdict(std::size_t i, HeadingVerdict verdict) {
  --report_.verdicts[static_cast<std::size_t>(headings_[i].verdict)];
  ++report_.verdicts[static_cast<std::size_t>(verdict)];
  headings_[i].verdict = verdict;
}

// The noise of a source that works changes its last digits.
bool HeadingConstraints::is_frozen(const PoseGraph& graph, std::size_t i) {
  if (headings_[i].yaw != headings_[repeated_].yaw) {
    repeated_ = i;
  }
  const double turned =
      yaw_of(axis_in_map(graph, headings_[i])) - yaw_of(axis_in_map(graph, headings_[repeated_]));
  return std::abs(wrapped_angle(turned)) > kFrozenTurn;
}

void HeadingConstraints::judge_new(const PoseGraph& graph, NodeId last) {
  for (; has_new(last); ++judged_) {
    const MapHeading& heading = headings_[judged_];
    const bool soon = last_kept_ && heading.stamp >= headings_[*last_kept_].stamp &&
                      seconds(heading.stamp - headings_[*last_kept_].stamp) < kHeadingTime;
    if (axis_in_map(graph, heading).head<2>().norm() < kLeastLevel) {
      set_verdict(judged_, HeadingVerdict::impossible);
    } else if (is_frozen(graph, judged_)) {
      set_verdict(judged_, HeadingVerdict::frozen);
    } else if (soon) {
      set_verdict(judged_, HeadingVerdict::thinned);
    } else {
      last_kept_ = judged_;
    }
  }
}

// Those of the first part of the map that can agree, in order. The others are apart.
std::vector<std::size_t> HeadingConstraints::part_of(const PoseGraph& graph) {
  const FirstPart first(graph);
  std::vector<std::size_t> part;
  for (std::size_t i = 0; i < judged_; ++i) {
    if (!can_agree(headings_[i].verdict)) {
      continue;
    }
    if (first.has(headings_[i].keyframe)) {
      part.push_back(i);
    } else {
      set_verdict(i, HeadingVerdict::apart);
    }
  }
  return part;
}

std::vector<double> HeadingConstraints::shares_of(std::span<const std::size_t> part) const {
  std::vector<double> times;
  for (const std::size_t i : part) {
    times.push_back(seconds(headings_[i].stamp - headings_.front().stamp));
  }
  return independent_shares(times, config_.correlation);
}

void HeadingConstraints::assess(const PoseGraph& graph, const Eigen::Matrix3d& levelling,
                                const PlacedMap& place, const std::optional<MapYaw>& by_fixes) {
  const std::vector<std::size_t> part = part_of(graph);
  const std::vector<double> shares = shares_of(part);
  std::vector<YawSample> samples;
  for (std::size_t k = 0; k < part.size(); ++k) {
    const MapHeading& heading = headings_[part[k]];
    const double in_map = yaw_of(levelling * axis_in_map(graph, heading));
    samples.push_back({.yaw = heading.yaw + convergence_of(graph, heading, place) - in_map,
                       .sigma = heading.sigma,
                       .share = shares[k]});
  }
  yaw_.reset();
  report_.offset.reset();
  // A frozen one counts against its source.
  report_.asked = part.size() + report_.verdicts[static_cast<std::size_t>(HeadingVerdict::frozen)];
  report_.agreeing = 0;
  report_.state = any() ? HeadingState::waiting : HeadingState::none;
  const std::optional<YawConsensus> found = yaw_consensus(samples);
  if (found) {
    report_.agreeing = found->agreeing;
    const MapYaw yaw{.yaw = found->yaw, .sigma = std::hypot(found->sigma, config_.heading_offset)};
    report_.state =
        2 * found->agreeing >= report_.asked ? HeadingState::used : HeadingState::scattered;
    if (by_fixes && by_fixes->sigma < kRoughFixYaw) {
      const double offset = wrapped_angle(yaw.yaw - by_fixes->yaw);
      report_.offset = offset;
      report_.offset_sigma = std::hypot(yaw.sigma, by_fixes->sigma, kMapYaw);
      const double normalized = offset / report_.offset_sigma;
      if (report_.state == HeadingState::used && normalized * normalized > kHeadingGate) {
        report_.state = HeadingState::contradicted;
      }
    }
    if (report_.state == HeadingState::used) {
      yaw_ = yaw;
    }
  }
  for (std::size_t k = 0; k < part.size(); ++k) {
    set_verdict(part[k], !found             ? HeadingVerdict::waiting
                         : !yaw_            ? HeadingVerdict::refused
                         : found->agrees[k] ? HeadingVerdict::used
                                            : HeadingVerdict::outlier);
  }
}

std::vector<MapHeading> HeadingConstraints::used(const PoseGraph& graph) const {
  std::vector<MapHeading> all = earlier_;
  const FirstPart first(graph);
  std::vector<std::size_t> part;
  for (std::size_t i = 0; yaw_ && i < judged_; ++i) {
    if (headings_[i].verdict == HeadingVerdict::used && first.has(headings_[i].keyframe)) {
      part.push_back(i);
    }
  }
  const std::vector<double> shares = shares_of(part);
  double sum = 0.0;
  for (std::size_t k = 0; k < part.size(); ++k) {
    MapHeading& heading = all.emplace_back(headings_[part[k]]);
    heading.information = shares[k] / (heading.sigma * heading.sigma);
    sum += heading.information;
  }
  const double most = 1.0 / (config_.heading_offset * config_.heading_offset);
  for (MapHeading& heading : std::span(all).subspan(earlier_.size())) {
    heading.information *= most / (most + sum);
  }
  return all;
}

void HeadingConstraints::judge_again(const PoseGraph& graph, const WorldFrame& frame) {
  if (!yaw_) {
    return;
  }
  const PlacedMap place{.frame = &frame, .T_world_map = graph.T_world_map()};
  double squares = 0.0;
  double chi2 = 0.0;
  std::size_t used = 0;
  for (const std::size_t i : part_of(graph)) {
    MapHeading& heading = headings_[i];
    const double innovation =
        wrapped_angle(heading.yaw + convergence_of(graph, heading, place) -
                      yaw_of(graph.T_world_map().linear() * axis_in_map(graph, heading)));
    const double deviation = std::hypot(heading.sigma, config_.heading_offset, kMapYaw);
    heading.chi2 = innovation * innovation / (deviation * deviation);
    set_verdict(i, heading.chi2 < kHeadingGate ? HeadingVerdict::used : HeadingVerdict::outlier);
    if (heading.verdict == HeadingVerdict::used) {
      squares += innovation * innovation;
      chi2 += heading.chi2;
      ++used;
    }
  }
  const auto count = static_cast<double>(std::max<std::size_t>(1, used));
  report_.innovation = std::sqrt(squares / count);
  report_.innovation_squared = chi2 / count;
}

void HeadingConstraints::forget_place() {
  earlier_.clear();  // they led to that place
  yaw_.reset();
  report_.state = report_.state == HeadingState::used ? HeadingState::waiting : report_.state;
  report_.placed = false;
  report_.innovation = 0.0;
  for (std::size_t i = 0; i < judged_; ++i) {
    if (can_agree(headings_[i].verdict) && headings_[i].verdict != HeadingVerdict::refused) {
      set_verdict(i, HeadingVerdict::waiting);
    }
  }
}

}  // namespace adit
