// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/foxglove/foxglove_graph.hpp"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include <fmt/core.h>

#include "adit/tools/map_database/odometry_chain.hpp"

namespace adit {
namespace {

constexpr std::size_t kMostPosesShown = 65'535;
constexpr std::size_t kMostEllipsoids = 2'000;
constexpr double kSigmasShown = 3.0;
constexpr double kKeyframeSize = 0.25;  // m

constexpr ShownColour kWay{.r = 0.15, .g = 0.55, .b = 1.0, .a = 1.0};
constexpr ShownColour kOdometryWay{.r = 0.6, .g = 0.6, .b = 0.6, .a = 0.8};
constexpr ShownColour kKeyframeColour{.r = 1.0, .g = 0.8, .b = 0.2, .a = 1.0};
constexpr ShownColour kConstraintColour{.r = 0.45, .g = 0.7, .b = 0.75, .a = 0.8};
constexpr ShownColour kUncertain{.r = 0.8, .g = 0.4, .b = 1.0, .a = 0.35};

std::size_t stride_for(std::size_t count, std::size_t most) {
  return std::max<std::size_t>(1, (count + most - 1) / most);
}

/// In the order in which viewers draw them, accepted ones last.
constexpr std::array kVerdictsShown = {CandidateVerdict::rejected, CandidateVerdict::waiting,
                                       CandidateVerdict::revoked, CandidateVerdict::accepted};

ShownColour colour_of(CandidateVerdict verdict) {
  switch (verdict) {
    case CandidateVerdict::accepted:
      return {.r = 0.2, .g = 0.9, .b = 0.3, .a = 1.0};
    case CandidateVerdict::rejected:
      return {.r = 0.95, .g = 0.25, .b = 0.2, .a = 0.6};
    case CandidateVerdict::revoked:
      return {.r = 1.0, .g = 0.5, .b = 0.1, .a = 0.8};
    case CandidateVerdict::waiting:
      break;
  }
  return {.r = 0.8, .g = 0.8, .b = 0.8, .a = 0.6};
}

using KeyframesById = std::unordered_map<NodeId, const MapKeyframe*>;

KeyframesById by_id(const std::vector<MapKeyframe>& keyframes) {
  KeyframesById ids;
  for (const MapKeyframe& keyframe : keyframes) {
    ids.emplace(keyframe.id, &keyframe);
  }
  return ids;
}

/// Adds the two ends, where both are known.
void tie(ShownLines& lines, const KeyframesById& keyframes, NodeId from, NodeId to) {
  const auto a = keyframes.find(from);
  const auto b = keyframes.find(to);
  if (a != keyframes.end() && b != keyframes.end()) {
    lines.points.emplace_back(a->second->T_map_keyframe.translation());
    lines.points.emplace_back(b->second->T_map_keyframe.translation());
  }
}

ShownPart shown_keyframes(const std::vector<MapKeyframe>& keyframes) {
  ShownPart part{.topic = kKeyframesTopic, .entity = {.id = "keyframes"}};
  for (const MapKeyframe& keyframe : keyframes) {
    part.entity.boxes.push_back({.pose = keyframe.T_map_keyframe,
                                 .size = Eigen::Vector3d::Constant(kKeyframeSize),
                                 .colour = kKeyframeColour});
  }
  return part;
}

ShownPart shown_odometry(const std::vector<MapKeyframe>& keyframes, const PoseGraph& graph) {
  ShownLines way{.colour = kOdometryWay};
  for (const Eigen::Isometry3d& pose : odometry_chain(keyframes, graph)) {
    way.points.emplace_back(pose.translation());
  }
  return {.topic = kOdometryTopic, .entity = {.id = "odometry", .lines = {std::move(way)}}};
}

ShownPart shown_constraints(const PoseGraph& graph, const KeyframesById& keyframes) {
  ShownLines lines{.strip = false, .width = 1.5, .colour = kConstraintColour};
  for (const PoseEdge& edge : graph.edges()) {
    if (edge.kind == EdgeKind::odometry && edge.status == EdgeStatus::active) {
      tie(lines, keyframes, edge.from, edge.to);
    }
  }
  return {.topic = kConstraintsTopic, .entity = {.id = "constraints", .lines = {std::move(lines)}}};
}

ShownPart shown_loops(const std::vector<LoopCandidate>& loops, const KeyframesById& keyframes) {
  ShownPart part{.topic = kLoopsTopic, .entity = {.id = "loops"}};
  for (const CandidateVerdict verdict : kVerdictsShown) {
    ShownLines lines{.strip = false,
                     .width = verdict == CandidateVerdict::accepted ? 3.0 : 1.0,
                     .colour = colour_of(verdict)};
    for (const LoopCandidate& loop : loops) {
      if (loop.verdict == verdict) {
        tie(lines, keyframes, loop.from, loop.to);
      }
    }
    if (!lines.points.empty()) {
      part.entity.lines.push_back(std::move(lines));
    }
  }
  return part;
}

ShownPart shown_uncertainty(const std::vector<MapKeyframe>& keyframes) {
  ShownPart part{.topic = kUncertaintyTopic, .entity = {.id = "uncertainty"}};
  const std::size_t stride = stride_for(keyframes.size(), kMostEllipsoids);
  for (std::size_t i = 0; i < keyframes.size(); i += stride) {
    const Eigen::Matrix3d covariance = keyframes[i].covariance.topLeftCorner<3, 3>();
    if (covariance.allFinite()) {
      ShownBody body = uncertainty_ellipsoid(keyframes[i].T_map_keyframe, covariance, kSigmasShown);
      body.colour = kUncertain;
      part.entity.ellipsoids.push_back(body);
    }
  }
  return part;
}

}  // namespace

ShownPart shown_trajectory(std::span<const StampedPose> poses, std::span<const std::size_t> parts) {
  ShownPart part{.topic = kTrajectoryTopic, .entity = {.id = "trajectory"}};
  const std::size_t stride = stride_for(poses.size(), kMostPosesShown);
  std::size_t next_part = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const bool begins = next_part < parts.size() && i == parts[next_part];
    next_part += begins ? 1U : 0U;
    if (i == 0 || begins) {
      part.entity.lines.push_back({.width = 3.0, .colour = kWay});
    }
    if (begins || i % stride == 0 || i + 1 == poses.size()) {
      part.entity.lines.back().points.emplace_back(poses[i].pose.translation());
    }
  }
  return part;
}

std::vector<ShownPart> shown_graph(const MapStore& map) {
  const std::vector<MapKeyframe> keyframes = map.keyframes();
  const PoseGraph graph = map.graph();
  const KeyframesById ids = by_id(keyframes);
  return {shown_keyframes(keyframes), shown_odometry(keyframes, graph),
          shown_constraints(graph, ids), shown_loops(map.candidates(), ids),
          shown_uncertainty(keyframes)};
}

std::vector<ShownEvent> loop_events(const MapStore& map) {
  const std::vector<MapKeyframe> keyframes = map.keyframes();
  const KeyframesById ids = by_id(keyframes);
  std::vector<ShownEvent> events;
  for (const LoopCandidate& loop : map.candidates()) {
    const auto later = ids.find(loop.to);
    if (later == ids.end()) {
      continue;
    }
    const bool counts = loop.verdict == CandidateVerdict::accepted;
    events.push_back({.stamp = later->second->stamp,
                      .level = counts ? ShownLevel::info : ShownLevel::debug,
                      .text = fmt::format("loop {}, keyframes {} and {}: {}", loop.id, loop.from,
                                          loop.to, to_string(loop.verdict)) +
                              (counts ? fmt::format(", corrects by {:.2f} m", loop.correction)
                                      : " (" + loop.reason + ")")});
  }
  return events;
}

}  // namespace adit
