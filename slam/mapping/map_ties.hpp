// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// One map of many, of which each pair was searched by itself: pairs can be searched on as many
// machines as there are.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "adit/slam/mapping/map_merge.hpp"
#include "adit/slam/mapping/map_store.hpp"

namespace adit {

/// What ties two maps to each other. Keyframes have the ids of their own maps.
struct MapTie {
  std::size_t one = 0;                      ///< number of a map
  std::size_t other = 0;                    ///< of another one, which comes later
  MergeSearch search{};                     ///< what the search has found; maps are 0 and 1 in it
  std::vector<PoseEdge> edges{};            ///< that count, from a keyframe of `one` to `other`
  std::vector<LoopCandidate> candidates{};  ///< between the two
  std::string not_searched{};               ///< why, where one of the maps cannot be searched
};

/// What merge_maps() has found for two maps, which get the numbers `one` and `other`.
MapTie tie_between(const MergedMap& merged, std::size_t one, std::size_t other);

struct JoinedMaps {
  MergedMap merged{};                       ///< of the largest group of maps that are tied
  std::vector<std::size_t> contradicted{};  ///< ties that the others contradict, by their order
};

/// Joins maps by ties of pairs. The largest group (in keyframes) of maps that ties lead to is
/// taken; those with the most tied keyframes say where each map begins. Then all ties are optimised
/// together, under a kernel that takes all influence from wrong edges (optimize_with_loops()): the
/// tie whose edges fit worst is left out while more than half of its edges are beyond kLoopReview,
/// one at a time; then the edges that are beyond it are revoked. The order of `maps` decides which
/// ids keyframes get, that of `ties` nothing.
JoinedMaps join_maps(std::span<const MapStore* const> maps, std::span<const MapTie> ties);

}  // namespace adit
