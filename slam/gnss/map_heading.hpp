// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "adit/slam/core/types.hpp"
#include "adit/slam/gnss/world_frame.hpp"
#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

enum class HeadingVerdict {
  waiting,     ///< the map's place in the world is not known yet
  used,        ///< it ties the map to the world
  thinned,     ///< too soon after the last
  outlier,     ///< the map points elsewhere
  frozen,      ///< the source repeats a heading while the sensor turns
  impossible,  ///< the axis stands too upright to have a heading
  apart,       ///< its part of the map is tied to the others by nothing
  refused,     ///< the whole source is
};
/// The enumerator's name.
constexpr std::string_view to_string(HeadingVerdict verdict) {
  constexpr std::array<std::string_view, 8> kNames = {
      "waiting", "used", "thinned", "outlier", "frozen", "impossible", "apart", "refused"};
  return kNames.at(static_cast<std::size_t>(verdict));
}
inline constexpr std::size_t kHeadingVerdicts = 8;

/// A heading with its place in the map, and what became of it.
struct MapHeading {
  NodeId keyframe = 0;  ///< among whose sweeps it falls
  Nanoseconds stamp{0};
  double yaw = 0.0;    ///< rad, counter-clockwise from true east
  double sigma = 0.0;  ///< rad, as it counts: heading_deviation()
  /// The sensor's x axis when it was taken, by the odometry, in the keyframe's axes.
  Eigen::Vector3d axis_keyframe = Eigen::Vector3d::UnitX();
  HeadingVerdict verdict = HeadingVerdict::waiting;
  /// What it counts with in the graph, 1/rad^2: less than sigma says, by what it shares with the
  /// others. Zero where it is not used.
  double information = 0.0;
  double chi2 =
      0.0;  ///< of its distance from the map's, with its error and the source's common one
};

/// A heading that is used, for the graph: of the axis projected on the level as the graph has it,
/// and against the world's y axis, which differs from true north by where T_world_map has the node.
MeasuredHeading as_measured(const MapHeading& heading, const PoseGraph& graph,
                            const WorldFrame& frame);

/// What a run makes of its source of headings as a whole.
enum class HeadingState {
  none,          ///< there is none
  waiting,       ///< too few headings so far, or the map has no place
  used,          ///< those that agree tie the map to the world
  scattered,     ///< refused: fewer than half agree on the map's yaw, by the odometry's turns
  contradicted,  ///< refused: the fixes place the map at another yaw
};
/// The enumerator's name.
constexpr std::string_view to_string(HeadingState state) {
  constexpr std::array<std::string_view, 5> kNames = {"none", "waiting", "used", "scattered",
                                                      "contradicted"};
  return kNames.at(static_cast<std::size_t>(state));
}

/// What has become of a run's headings.
struct HeadingReport {
  std::size_t headings = 0;                              ///< among the map's sweeps
  std::size_t outside = 0;                               ///< before the first, after the last
  std::size_t left_out = 0;                              ///< not finite
  std::array<std::size_t, kHeadingVerdicts> verdicts{};  ///< by HeadingVerdict
  HeadingState state = HeadingState::none;
  std::size_t asked = 0;     ///< those that could agree on the map's yaw
  std::size_t agreeing = 0;  ///< and those that do
  std::optional<double>
      offset{};               ///< rad, of them against the fixes; none: fixes do not give a yaw
  double offset_sigma = 0.0;  ///< rad, of what it may be if both are right
  double innovation = 0.0;    ///< rad, rms residual of the used ones
  double innovation_squared = 0.0;  ///< mean of it squared over its variance
  bool placed = false;              ///< the map's first place came by them
};

}  // namespace adit
