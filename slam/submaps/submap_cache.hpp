// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "adit/slam/core/recently_used.hpp"
#include "adit/slam/submaps/keyframe_submap.hpp"
#include "adit/slam/submaps/map_submap.hpp"

namespace adit {

/// Of submaps that stay in memory, unless it is said otherwise.
inline constexpr uint64_t kSubmapBytes = uint64_t{64} << 20U;

/// What a submap takes in memory, bytes.
uint64_t memory_of(const KeyframeSubmap& submap);

/// Submaps of a map, decoded. Those that were needed last stay, up to so many bytes; the others are
/// read again when they are needed.
class SubmapCache {
 public:
  /// The one that was asked for last stays even if it is larger than `most_bytes`.
  SubmapCache(SubmapLoader load, uint64_t most_bytes) : load_(std::move(load)), kept_(most_bytes) {}

  /// Throws what the loader does, and SubmapDamaged.
  std::shared_ptr<const KeyframeSubmap> get(NodeId keyframe);

  uint64_t bytes() const { return kept_.bytes(); }
  uint64_t reads() const { return reads_; }  ///< by the loader

 private:
  SubmapLoader load_;
  uint64_t reads_ = 0;
  RecentlyUsed<NodeId, std::shared_ptr<const KeyframeSubmap>> kept_;
};

}  // namespace adit
