// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What every page about the loops of a map shows first.
#pragma once

#include <span>
#include <string>

#include "adit/slam/mapping/map_store.hpp"
#include "adit/tools/map_database/map_database.hpp"

namespace adit {

/// How many loops there are with which verdict and reason, as HTML (dl).
std::string loop_counts(std::span<const LoopCandidate> loops);

/// Keyframes, path and accepted and revoked loops from above, as an SVG; of many evenly chosen
/// ones, so that it is small whatever the map. Both keyframes of each loop have to be in the graph.
std::string loops_from_above(const MapDatabase& map, const PoseGraph& graph,
                             std::span<const LoopCandidate> loops);

}  // namespace adit
