// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Whether parts of a map have been joined at the right place, in the light of what is found later
// (docs/theory/loops.md).
#pragma once

#include <cstddef>
#include <span>

#include "adit/slam/loops/loop_voting.hpp"

namespace adit {

/// The loop ties keyframes on both sides of the gap.
bool crosses(const PoseGraph& graph, const TrackingGap& gap, NodeId from, NodeId to);

/// Loops that were refused as they contradict a join would, had it not been made, make another one:
/// as many as this of their later keyframes agree, if more do than have loops that go on with the
/// join at that time; else 0. `accepted` are the graph's.
std::size_t agreeing_on_another_join(const PoseGraph& graph, const TrackingGap& gap,
                                     std::span<const LoopHypothesis> refused,
                                     std::span<const LoopHypothesis> accepted,
                                     std::span<const TrackingGap> gaps,
                                     const LoopVotingSettings& settings);

}  // namespace adit
