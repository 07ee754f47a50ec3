// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What a store holds of earlier sessions, for a session that is tied to them.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "adit/engine/context.hpp"
#include "adit/slam/loops/loop_closer.hpp"
#include "adit/slam/mapping/map_store.hpp"

namespace adit {

/// What becomes of the earlier sessions of a store when a new one is mapped.
enum class EarlierSessions {
  none,  ///< the new session does not read them
  move,  ///< the new session is tied to them, and what it shows of their drift corrects them
  keep,  ///< the new session is tied to them, and their keyframes stay where they are
};

/// The map that a new session begins with.
struct StoredMap {
  PoseGraph graph;                     ///< with the fixes that tie it to the world
  std::vector<EarlierPlace> places;    ///< in the order of the graph's nodes
  MapAliases aliases{};                ///< where it looks like itself
  int64_t last_candidate = 0;          ///< highest id; 0: none
  std::vector<MapFix> fixes{};         ///< in the order of their ids
  std::vector<MapHeading> headings{};  ///< that are used
  std::optional<Georeference> georeference{};
};

/// Reads it; places that were stored without a descriptor are described on the device. With
/// EarlierSessions::keep all nodes are fixed, and only the part that the map begins with is looked
/// for: nothing says where the others lie in its frame. Throws what the store throws, SubmapDamaged
/// and engine::OutOfMemory.
StoredMap read_stored_map(engine::Context& context, const MapStore& store,
                          EarlierSessions sessions);

}  // namespace adit
