// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/submaps/submap_cache.hpp"

#include <utility>

#include "adit/slam/submaps/submap_codec.hpp"

namespace adit {

uint64_t memory_of(const KeyframeSubmap& submap) {
  return sizeof submap + submap.sweeps.capacity() * sizeof(SubmapSweep) +
         submap.points.capacity() * sizeof(SubmapPoint);
}

std::shared_ptr<const KeyframeSubmap> SubmapCache::get(NodeId keyframe) {
  const auto known = places_.find(keyframe);
  if (known != places_.end()) {
    kept_.splice(kept_.begin(), kept_, known->second);
    return kept_.front().submap;
  }
  auto submap = std::make_shared<const KeyframeSubmap>(decode(load_(keyframe)));
  ++reads_;
  bytes_ += memory_of(*submap);
  kept_.push_front({.keyframe = keyframe, .submap = std::move(submap)});
  places_[keyframe] = kept_.begin();
  while (bytes_ > most_bytes_ && kept_.size() > 1) {
    bytes_ -= memory_of(*kept_.back().submap);
    places_.erase(kept_.back().keyframe);
    kept_.pop_back();
  }
  return kept_.front().submap;
}

}  // namespace adit
