// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Points of a map whose places on the Earth were surveyed (docs/theory/gnss.md).
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "adit/slam/gnss/world_frame.hpp"
#include "adit/slam/graph/loop_optimization.hpp"
#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

enum class ControlRole {
  control,  ///< the map is adjusted to it
  check,    ///< the map is only measured against it
};
/// The enumerator's name.
constexpr std::string_view to_string(ControlRole role) {
  return role == ControlRole::check ? "check" : "control";
}

/// A surveyed point, and where in the map it was marked.
struct ControlPoint {
  std::string name{};
  ControlRole role = ControlRole::control;
  NodeId keyframe = 0;                                   ///< that has seen it
  Eigen::Vector3d p_keyframe = Eigen::Vector3d::Zero();  ///< as marked, in its axes, m
  Eigen::Vector3d p_marked = Eigen::Vector3d::Zero();    ///< in the map as it was then, m
  Geodetic place;                                        ///< as surveyed
  /// Standard deviations of both together, east, north, up: m, greater than 0.
  Eigen::Vector3d sigma = Eigen::Vector3d(0.02, 0.02, 0.03);
};

/// It as what ties its keyframe to the world.
PositionFix as_measured(const ControlPoint& point, const WorldFrame& frame);

/// Where a graph has each point less where it lies: east, north, up, m.
std::vector<Eigen::Vector3d> control_errors(std::span<const ControlPoint> points,
                                            const PoseGraph& graph, const WorldFrame& frame);

/// Points that a map cannot be adjusted to. what() names them.
class ControlError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A map with its place on the Earth, adjusted to ground control.
struct GroundControl {
  Georeference georeference{};
  LoopOptimum optimum{};
  PoseGraph graph{};  ///< with the control points in it, and the poses of the optimum
  /// Errors of all points before the map has given way: by the place that it had, or else by the
  /// one that suits the control points best.
  std::vector<Eigen::Vector3d> before{};
  std::vector<Eigen::Vector3d> after{};  ///< and then
};

/// Adjusts a graph to its control points, besides whatever else holds it: edges, verticals and
/// GNSS fixes, under the same kernels as loops. A map without a place gets one: three control
/// points or more say it. Throws ControlError: too few, all at one place, or one of them (a
/// mistake, or two exchanged) does not fit the others as a map that has drifted by 1 % would; of
/// one or two, which do not fit the fixes.
GroundControl adjust_to_control(PoseGraph graph, const std::optional<Georeference>& georeference,
                                std::span<const ControlPoint> points,
                                const std::function<bool(const OptimizationStep&)>& on_step = {});

}  // namespace adit
