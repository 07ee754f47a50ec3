// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/slam/submaps/submap_cache.hpp"

#include "adit/slam/submaps/submap_codec.hpp"

namespace adit {

uint64_t memory_of(const KeyframeSubmap& submap) {
  return sizeof submap + submap.sweeps.capacity() * sizeof(SubmapSweep) +
         submap.points.capacity() * sizeof(SubmapPoint);
}

std::shared_ptr<const KeyframeSubmap> SubmapCache::get(NodeId keyframe) {
  if (const auto* known = kept_.find(keyframe)) {
    return *known;
  }
  auto submap = std::make_shared<const KeyframeSubmap>(decode(load_(keyframe)));
  ++reads_;
  return kept_.add(keyframe, submap, memory_of(*submap));
}

}  // namespace adit
