// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/merged_world.hpp"

#include <algorithm>
#include <utility>

#include "adit/slam/gnss/gnss_constraints.hpp"
#include "adit/slam/gnss/world_covariance.hpp"

namespace adit {
namespace {

/// Nodes of the part that the map begins with: the others lie nowhere in its frame.
class FirstComponent {
 public:
  explicit FirstComponent(const PoseGraph& graph)
      : graph_(&graph), component_of_(connected_components(graph).component_of) {}
  bool has(NodeId node) const {
    return component_of_[graph_->index_of(node)] == component_of_.front();
  }

 private:
  const PoseGraph* graph_;
  std::vector<std::size_t> component_of_;
};

std::vector<MapFix> numbered_fixes(const std::vector<WorldPart>& parts) {
  std::vector<MapFix> fixes;
  for (const WorldPart& part : parts) {
    const double path = fixes.empty() ? 0.0 : fixes.back().path;
    for (MapFix fix : part.fixes) {
      fix.id = static_cast<int64_t>(fixes.size()) + 1;
      fix.path += path;
      fixes.push_back(fix);
    }
  }
  return fixes;
}

void optimize(PoseGraph& graph) {
  const LoopOptimum optimum = optimize_with_loops(graph);
  if (optimum.report.termination != Termination::failed) {
    graph.set_poses(optimum.poses);
    graph.set_T_world_map(optimum.T_world_map);
  }
}

/// As one run would have it. False: the fixes do not say where the map lies.
bool place_by_fixes(MergedWorld& merged, const GnssConfig& config) {
  GnssConstraints ties(config);
  ties.begin_behind(merged.fixes, merged.headings, std::nullopt);
  PoseGraph graph = merged.graph;
  const GnssConstraints::Change change = ties.finish(graph);
  if (!change.georeference) {
    return false;
  }
  merged.graph = std::move(graph);
  merged.georeference = change.georeference;
  for (const MapFix& fix : change.fixes) {
    merged.fixes[static_cast<std::size_t>(fix.id) - 1] = fix;
  }
  return true;
}

/// The part whose place the merged map takes: one with control points before others.
const WorldPart* reference_of(const std::vector<WorldPart>& parts, const FirstComponent& first) {
  const WorldPart* best = nullptr;
  for (const WorldPart& part : parts) {
    if (part.georeference && first.has(part.first) &&
        (best == nullptr || (best->control.empty() && !part.control.empty()))) {
      best = &part;
    }
  }
  return best;
}

/// By the place that one part has, and by what ties all of them to the world.
void place_by_reference(MergedWorld& merged, const WorldPart& reference) {
  PoseGraph& graph = merged.graph;
  const FirstComponent first(graph);
  const Eigen::Isometry3d T_merged_part =
      graph.nodes()[graph.index_of(reference.first)].T_map_node * reference.T_part_first.inverse();
  const Georeference& known = *reference.georeference;
  const WorldFrame frame(known.origin);
  graph.set_T_world_map(orthonormalized(known.T_world_map * T_merged_part.inverse()));
  for (const MapFix& fix : merged.fixes) {
    if (fix.verdict == FixVerdict::used && first.has(fix.keyframe)) {
      graph.add_fix(as_measured(fix, frame));
    }
  }
  for (const MapHeading& heading : merged.headings) {
    if (first.has(heading.keyframe)) {
      graph.add_heading(as_measured(heading, graph, frame));
    }
  }
  for (const ControlPoint& point : merged.control) {
    if (point.role == ControlRole::control && first.has(point.keyframe)) {
      graph.add_fix(as_measured(point, frame));
    }
  }
  optimize(graph);
  merged.georeference = Georeference{.origin = known.origin,
                                     .T_world_map = graph.T_world_map(),
                                     .covariance = covariance_of_world(graph)};
}

}  // namespace

MergedWorld place_in_world(PoseGraph graph, const std::vector<WorldPart>& parts,
                           const GnssConfig& config) {
  MergedWorld merged{.graph = std::move(graph), .fixes = numbered_fixes(parts)};
  for (const WorldPart& part : parts) {
    merged.control.insert(merged.control.end(), part.control.begin(), part.control.end());
    merged.headings.insert(merged.headings.end(), part.headings.begin(), part.headings.end());
  }
  const FirstComponent first(merged.graph);
  const bool has_control = std::ranges::any_of(merged.control, [&](const ControlPoint& point) {
    return point.role == ControlRole::control && first.has(point.keyframe);
  });
  if (!has_control && place_by_fixes(merged, config)) {
    return merged;
  }
  if (const WorldPart* reference = reference_of(parts, first)) {
    place_by_reference(merged, *reference);
  } else {
    optimize(merged.graph);
  }
  return merged;
}

}  // namespace adit
