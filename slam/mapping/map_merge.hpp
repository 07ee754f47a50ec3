// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Finds the places that maps have in common and ties the maps to one (docs/theory/loops.md).
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "adit/slam/core/config.hpp"
#include "adit/slam/mapping/map_store.hpp"
#include "adit/slam/submaps/map_memory.hpp"

namespace adit {

/// A map within a merged one, which has its keyframes one after another.
struct MergedPart {
  std::size_t map = 0;           ///< its number among the maps that were given
  NodeId first = 0;              ///< id of its first keyframe in the merged map
  std::vector<NodeId> stored{};  ///< ids of its keyframes in its own store, in order

  /// The id in the merged map of a keyframe of its store.
  NodeId merged(NodeId keyframe) const;
};

/// The search for one map in those that are tied already.
struct MergeSearch {
  std::vector<std::size_t> in{};  ///< numbers of the maps that it was searched for in
  std::size_t map = 0;            ///< its own number
  std::size_t candidates = 0;     ///< pairs of keyframes that were compared
  std::size_t verified = 0;       ///< of them: their submaps fit
  std::size_t accepted = 0;       ///< of them: edges that count
  std::size_t keyframes = 0;      ///< of the map, with such an edge
  /// Natural logarithm of the best odds of a place for the map against the likeliest alternative;
  /// none: no bundle of loops agreed on a place.
  std::optional<double> log_odds{};
  /// The same of the odds that common places are the same, against that they are only built alike;
  /// none: it was not tied.
  std::optional<double> built_alike_log_odds{};
  bool is_tied = false;
};

/// Maps that are tied to each other.
struct MergedMap {
  std::vector<MergedPart> parts{};      ///< in the order in which they were tied; the first alone
                                        ///< where nothing was
  std::vector<MergeSearch> searches{};  ///< in the order in which they were made
  /// Of all parts, without ties to the world: edges of the parts in their order, and those between
  /// a part and earlier ones after its own.
  PoseGraph graph{};
  std::vector<LoopCandidate> candidates{};  ///< of all parts and between them, by id
};

/// How far a merge is.
struct MergeStep {
  const MergeSearch* search = nullptr;  ///< the present one
  std::size_t done = 0;                 ///< keyframes in this search, each pass counted
};

/// A merge that was asked to stop.
class MergeStopped : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct MergeSettings {
  /// The maps are known to be of one site: a place that none of them has does not compete.
  bool same_site = false;
};

/// Ties the maps to each other as far as they have places in common. A map comes in by at least
/// four of its keyframes whose loops agree, and only if no other place is nearly as likely
/// (docs/theory/loops.md). Maps that are tied to nothing are left out; where nothing is tied to the
/// first map, the second is tried as the first, and so on. The order of `maps` decides which ids
/// keyframes get: callers sort them. Each has keyframes.
///
/// `on_step` is asked after each keyframe; false ends the merge with MergeStopped. Throws what the
/// stores throw, SubmapDamaged and engine::OutOfMemory.
MergedMap merge_maps(engine::Context& context, const Config& config,
                     std::span<const MapStore* const> maps, const MapMemory& memory,
                     const MergeSettings& settings,
                     const std::function<bool(const MergeStep&)>& on_step);

}  // namespace adit
