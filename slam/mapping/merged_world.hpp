// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// The place of merged maps on the Earth, by the GNSS fixes and control points of all of them, and
// the one optimisation of the merged graph.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/slam/gnss/ground_control.hpp"
#include "adit/slam/gnss/map_fix.hpp"
#include "adit/slam/gnss/map_heading.hpp"
#include "adit/slam/gnss/world_frame.hpp"
#include "adit/slam/graph/loop_optimization.hpp"

namespace adit {

/// What ties one of the maps to the world, by keyframes of the merged map.
struct WorldPart {
  NodeId first = 0;                                                ///< its first keyframe
  Eigen::Isometry3d T_part_first = Eigen::Isometry3d::Identity();  ///< that one's in its own map
  std::vector<MapFix> fixes{};                                     ///< in the order of their ids
  std::vector<MapHeading> headings{};                              ///< that are used
  std::vector<ControlPoint> control{};
  std::optional<Georeference> georeference{};  ///< of its own map
};

struct MergedWorld {
  PoseGraph graph{};                   ///< optimised, with what ties it to the world
  std::vector<MapFix> fixes{};         ///< of all parts, numbered from 1 in the order of the parts
  std::vector<MapHeading> headings{};  ///< of all parts, in their order
  std::vector<ControlPoint> control{};
  std::optional<Georeference> georeference{};
};

/// Optimises the graph with all that ties it to the world. Without control points the fixes of all
/// parts say where the map lies, as if one run had collected them. Control points, or fixes that
/// are too few for that, tie the map to the place that their own map had; the fixes that count in
/// the maps count there, too.
MergedWorld place_in_world(PoseGraph graph, const std::vector<WorldPart>& parts,
                           const GnssConfig& config);

}  // namespace adit
