// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/gnss/ground_control.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "adit/slam/core/median.hpp"
#include "adit/slam/core/text.hpp"
#include "adit/slam/gnss/gnss_noise.hpp"
#include "adit/slam/gnss/world_covariance.hpp"
#include "adit/slam/gnss/world_fit.hpp"

namespace adit {
namespace {

constexpr std::size_t kFewestToPlace = 3;
// What a map as it is may be off by: standard deviations, besides those of the points.
constexpr double kDriftLevel = 0.01;  // of the distance between the points farthest apart
constexpr double kDriftUp = 0.03;
constexpr double kControlGate = 3.29;  // 99.9 %
// What fixes may have in common that no map shows: where the antenna sits, the datum. m.
constexpr double kFixNoise = 0.3;

Eigen::Vector3d p_map(const ControlPoint& point, const PoseGraph& graph) {
  return graph.nodes()[graph.index_of(point.keyframe)].T_map_node * point.p_keyframe;
}

bool is_control(const ControlPoint& point) {
  return point.role == ControlRole::control;
}

std::string names_of(const std::vector<const ControlPoint*>& points) {
  std::string names;
  for (const ControlPoint* point : points) {
    names += (names.empty() ? "" : ", ") + point->name;
  }
  return names;
}

/// By the control points alone, with the map as it is.
Eigen::Isometry3d place_by_control(const PoseGraph& graph, std::span<const ControlPoint> points,
                                   const WorldFrame& frame) {
  std::vector<PositionPair> pairs;
  std::vector<const ControlPoint*> of;
  for (const ControlPoint& point : points) {
    if (is_control(point)) {
      pairs.push_back({.p_map = p_map(point, graph),
                       .p_world = frame.position_of(point.place),
                       .covariance = point.sigma.cwiseAbs2().asDiagonal(),
                       .time = static_cast<double>(pairs.size())});
      of.push_back(&point);
    }
  }
  constexpr double kNothingInCommon = 1e-3;  // s: points are surveyed one by one
  const std::optional<WorldFit> fit = fit_world(pairs, kNothingInCommon);
  if (!fit) {
    throw ControlError("no three of the control points lie to each other as the map has them (" +
                       names_of(of) + "), or all lie at one place");
  }
  std::vector<double> heights;  // of the place that each point alone would say
  double extent = 0.0;
  for (const PositionPair& pair : pairs) {
    heights.push_back(pair.p_world.z() - pair.p_map.z());
    for (const PositionPair& other : pairs) {
      extent = std::max(extent, (pair.p_world - other.p_world).head<2>().norm());
    }
  }
  const double height = median(heights);
  std::vector<const ControlPoint*> odd;
  for (std::size_t i = 0; i < of.size(); ++i) {
    const Eigen::Vector3d& sigma = of[i]->sigma;
    const double off = (fit->T_world_map * pairs[i].p_map - pairs[i].p_world).head<2>().norm();
    if (off > kControlGate *
                  std::hypot(sigma.head<2>().maxCoeff(), kDriftLevel * extent, kMapNoise) ||
        std::abs(heights[i] - height) >
            kControlGate * std::hypot(sigma.z(), kDriftUp * extent, kMapNoise)) {
      odd.push_back(of[i]);
    }
  }
  if (!odd.empty()) {
    throw ControlError("the others do not agree with " + names_of(odd));
  }
  return fit->T_world_map;
}

/// Of nodes that a fix ties to the world, by edges.
std::vector<bool> are_tied(const PoseGraph& graph) {
  const GraphComponents components = connected_components(graph);
  std::vector<bool> tied(components.components.size(), false);
  for (const PositionFix& fix : graph.fixes()) {
    tied[components.component_of[graph.index_of(fix.node)]] = true;
  }
  std::vector<bool> of_nodes;
  for (const std::size_t component : components.component_of) {
    of_nodes.push_back(tied[component]);
  }
  return of_nodes;
}

/// Where the fixes alone have the map, its control points must lie, to within what these, the fixes
/// and the way between leave open.
void hold_against_fixes(PoseGraph graph, std::span<const ControlPoint> points,
                        const WorldFrame& frame,
                        const std::function<bool(const OptimizationStep&)>& on_step) {
  const LoopOptimum optimum = optimize_with_loops(graph, on_step);
  if (optimum.report.termination == Termination::stopped) {
    return;
  }
  graph.set_poses(optimum.poses);
  graph.set_T_world_map(optimum.T_world_map);
  std::vector<NodeId> nodes;
  for (const ControlPoint& point : points) {
    nodes.push_back(point.keyframe);
  }
  const std::vector<Eigen::Matrix3d> covariances = world_covariances(graph, nodes);
  const std::vector<Eigen::Vector3d> errors = control_errors(points, graph, frame);
  const std::vector<bool> tied = are_tied(graph);
  std::string odd;
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    const ControlPoint& point = points[i];
    const Eigen::Vector3d variance = covariances[i].diagonal() + point.sigma.cwiseAbs2();
    const double reach = point.p_keyframe.norm();
    const double level = errors[i].head<2>().norm();
    const double up = std::abs(errors[i].z());
    if (is_control(point) && tied[graph.index_of(point.keyframe)] &&
        (level > kControlGate * std::hypot(std::sqrt(variance.head<2>().maxCoeff()),
                                           kDriftLevel * reach, kFixNoise) ||
         up > kControlGate * std::hypot(std::sqrt(variance.z()), kDriftUp * reach, kFixNoise))) {
      odd += (odd.empty() ? "" : ", ") + point.name + " (" + with_decimals(level, 2) +
             " m level, " + with_decimals(up, 2) + " m up)";
    }
  }
  if (!odd.empty()) {
    throw ControlError("the GNSS fixes do not agree with " + odd +
                       "; three control points that agree with each other would count for more");
  }
}

}  // namespace

PositionFix as_measured(const ControlPoint& point, const WorldFrame& frame) {
  return {.node = point.keyframe,
          .p_node = point.p_keyframe,
          .p_world = frame.position_of(point.place),
          .information = point.sigma.cwiseAbs2().cwiseInverse().asDiagonal()};
}

std::vector<Eigen::Vector3d> control_errors(std::span<const ControlPoint> points,
                                            const PoseGraph& graph, const WorldFrame& frame) {
  std::vector<Eigen::Vector3d> errors;
  for (const ControlPoint& point : points) {
    errors.emplace_back(graph.T_world_map() * p_map(point, graph) - frame.position_of(point.place));
  }
  return errors;
}

GroundControl adjust_to_control(PoseGraph graph, const std::optional<Georeference>& georeference,
                                std::span<const ControlPoint> points,
                                const std::function<bool(const OptimizationStep&)>& on_step) {
  const auto controls = static_cast<std::size_t>(std::ranges::count_if(points, is_control));
  if (controls == 0) {
    throw ControlError("none of the points is control");
  }
  if (!georeference && controls < kFewestToPlace) {
    throw ControlError(
        "a map that GNSS has not placed needs three control points or more, there "
        "are " +
        std::to_string(controls));
  }
  GroundControl result;
  // A place that only earlier control points gave is given anew, also if that was a wrong one.
  const bool places = controls >= kFewestToPlace && graph.fixes().empty();
  result.georeference.origin =
      places ? std::ranges::find_if(points, is_control)->place : georeference->origin;
  const WorldFrame frame(result.georeference.origin);
  if (controls >= kFewestToPlace) {  // fewer cannot contradict each other
    const Eigen::Isometry3d T_world_map = place_by_control(graph, points, frame);
    if (places) {
      graph.set_T_world_map(T_world_map);
    }
  } else if (!graph.fixes().empty()) {
    hold_against_fixes(graph, points, frame, on_step);
  }
  result.before = control_errors(points, graph, frame);
  for (const ControlPoint& point : points) {
    if (is_control(point)) {
      graph.add_fix(as_measured(point, frame));
    }
  }
  result.optimum = optimize_with_loops(graph, on_step);
  graph.set_poses(result.optimum.poses);
  graph.set_T_world_map(result.optimum.T_world_map);
  result.after = control_errors(points, graph, frame);
  result.georeference.T_world_map = result.optimum.T_world_map;
  result.georeference.covariance = covariance_of_world(graph);
  result.graph = std::move(graph);
  return result;
}

}  // namespace adit
