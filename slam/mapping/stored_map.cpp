// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/mapping/stored_map.hpp"

#include <algorithm>

#include "adit/slam/submaps/submap_codec.hpp"

namespace adit {
namespace {

/// As it was stored; maps that were made without a search for loops have none.
std::optional<PlaceDescriptor> descriptor_of(engine::Context& context, const MapSubmap& stored) {
  if (const auto descriptor = decode_descriptor(stored)) {
    return descriptor;
  }
  const KeyframeSubmap submap = decode(stored);
  return PlaceIndex(context).add(make_surface_cloud(context, submap), plan_cell(submap.r_submap));
}

}  // namespace

StoredMap read_stored_map(engine::Context& context, const MapStore& store,
                          EarlierSessions sessions) {
  StoredMap earlier;
  if (sessions == EarlierSessions::none) {
    return earlier;
  }
  const bool keeps = sessions == EarlierSessions::keep;
  earlier.graph = store.graph();
  const std::vector<std::size_t> part_of = connected_components(earlier.graph).component_of;
  const std::vector<MapKeyframe> keyframes = store.keyframes();
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const bool levelled = keyframes[i].vertical != Vertical::unknown;
    EarlierPlace place{.levelled = levelled};
    if (levelled && !(keeps && part_of[i] != part_of.front())) {
      place.descriptor = descriptor_of(context, store.submap(keyframes[i].id));
    }
    earlier.places.push_back(std::move(place));
    if (keeps) {
      earlier.graph.set_fixed(keyframes[i].id, true);
    }
  }
  const std::vector<LoopCandidate> candidates = store.candidates();
  earlier.aliases = map_aliases(earlier.graph, candidates);
  for (const LoopCandidate& candidate : candidates) {
    earlier.last_candidate = std::max(earlier.last_candidate, candidate.id);
  }
  earlier.fixes = store.fixes();
  std::ranges::sort(earlier.fixes, {}, &MapFix::id);
  earlier.headings = store.headings();
  earlier.georeference = store.georeference();
  return earlier;
}

}  // namespace adit
