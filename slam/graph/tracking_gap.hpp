// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What is known of the way over which the odometry has lost its track and started anew: it ties the
// parts of a map on both sides of it, loosely (docs/theory/loops.md).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "adit/slam/graph/pose_graph.hpp"

namespace adit {

/// Between a keyframe and the one before it. How far it has turned meanwhile, nothing says: turns
/// are what odometries lose their track in.
struct TrackingGap {
  NodeId after = 0;    ///< the keyframe behind it
  double reach = 0.0;  ///< m, horizontally, that it may have gone at the most
  double climb = 0.0;  ///< m, up or down, likewise
};

/// `speed` (m/s) is the highest before the gap, which may be exceeded a little.
TrackingGap tracking_gap(NodeId after, double seconds, double speed);

/// The last keyframe of one part and the first of another, with gaps between, and perhaps other
/// parts.
struct GapCrossing {
  NodeId last = 0;
  NodeId first = 0;
  double reach = 0.0;    ///< m, between the two, horizontally
  double climb = 0.0;    ///< m, up or down in the gaps themselves
  double rise = 0.0;     ///< m, that the parts between climb: how they are turned, nothing says
  double between = 0.0;  ///< m, that they go horizontally
};

/// Where, in the order of the nodes, one passes from the part of one of the two to the part of the
/// other, either way. Left out is where a gap is not known. `part_of` as
/// GraphComponents::component_of.
std::vector<GapCrossing> gap_crossings(const PoseGraph& graph, std::span<const std::size_t> part_of,
                                       std::span<const TrackingGap> gaps, std::size_t one_part,
                                       std::size_t other_part);

}  // namespace adit
