// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "adit/slam/graph/pose_graph.hpp"
#include "adit/slam/loops/loop_closer.hpp"

namespace adit {

/// How a keyframe looks at the place of an earlier map where its pose has it, by the verdicts on
/// candidates that position found. `earlier_nodes`: so many of the graph's first nodes are the
/// earlier map's. Not mapped: no keyframe of it was compared that is near enough to see the same.
PlaceLikeness::Kind likeness_by_position(const PoseGraph& graph, NodeId keyframe,
                                         std::span<const PendingLoop> found,
                                         std::size_t earlier_nodes);

/// The odds that a session is still where it was recognised in an earlier map, against that the
/// sensor was carried elsewhere (docs/theory/localization.md). Keyframes that look as the map has
/// their place restore them; each one that looks different lowers them.
class PlaceOdds {
 public:
  /// A keyframe `path` m behind the one before.
  void add(NodeId keyframe, PlaceLikeness::Kind kind, double path);
  /// The session was recognised, or is lost.
  void reset() { *this = {}; }

  /// At least 100 to 1 that it is there.
  bool is_sure() const;
  /// At least 20 to 1 that it is elsewhere.
  bool is_elsewhere() const;
  /// The first keyframe that looked different since one looked as the map has it.
  std::optional<NodeId> different_since() const { return since_; }

 private:
  double log_odds() const;

  std::size_t different_ = 0;  ///< keyframes, so far apart that each is evidence of its own
  double path_ = 0.0;          ///< m, since the last of them
  std::optional<NodeId> since_{};
};

}  // namespace adit
