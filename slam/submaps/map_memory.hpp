// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "adit/slam/submaps/submap_cache.hpp"

namespace adit {

/// What a map that grows may take of the memory.
struct MapMemory {
  /// Of an optimisation and the graph, measured: docs/theory/mapping.md.
  static constexpr uint64_t kBytesANode = 12 * 1024;

  uint64_t submap_bytes = kSubmapBytes;  ///< of stored submaps that stay in memory
  uint64_t graph_bytes = std::numeric_limits<uint64_t>::max();  ///< of optimisations

  /// Whether a graph of so many nodes may be optimised.
  bool can_optimize(std::size_t nodes) const { return nodes <= graph_bytes / kBytesANode; }
};

}  // namespace adit
