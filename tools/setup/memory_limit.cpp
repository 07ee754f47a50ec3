// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/setup/memory_limit.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "adit/slam/submaps/submap_cache.hpp"
#include "adit/tools/support/resident_memory.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

// What a run needs besides what is there before its first sweep: buffers of the device, the rolling
// submap, and sweeps on their way, those that are read ahead among them; for a map two keyframes'
// submaps; for loops pairs of submaps and kLeastSubmapBytes. tests/memory_bound.py measures it,
// docs/theory/mapping.md has what came out.
constexpr uint64_t kWorkingBytes = uint64_t{96} << 20U;
constexpr uint64_t kWorkingBytesAPoint = 368;
constexpr uint64_t kMapBytes = uint64_t{22} << 20U;
constexpr uint64_t kMapBytesAPoint = 512;
constexpr uint64_t kLoopBytes = uint64_t{24} << 20U;
constexpr uint64_t kLoopBytesAPoint = 256;

// Of the limit one part in so many is for the graph of a map.
constexpr uint64_t kGraphShare = 16;

// What is free goes back to the system before the limit is reached, by this share of it: the next
// keyframe needs room for a moment.
constexpr uint64_t kHeadroom = 4;

std::string mebibytes(uint64_t bytes) {
  return fmt::format("{} MiB", (bytes + (uint64_t{1} << 20U) - 1) >> 20U);
}

}  // namespace

uint64_t working_bytes(const MappingConfig& mapping, std::size_t points_a_sweep) {
  uint64_t bytes = kWorkingBytes + kWorkingBytesAPoint * points_a_sweep;
  if (mapping.enabled) {
    bytes += kMapBytes + kMapBytesAPoint * points_a_sweep;
    bytes += mapping.loops ? kLoopBytes + kLoopBytesAPoint * points_a_sweep : 0;
  }
  return bytes;
}

MemoryLimit::MemoryLimit(uint64_t most_bytes, uint64_t working_bytes, bool makes_map)
    : most_(most_bytes) {
  const uint64_t at_start = resident_bytes();
  const uint64_t without_graph = at_start + working_bytes;
  const uint64_t needed =
      makes_map ? without_graph + without_graph / (kGraphShare - 1) + 1 : without_graph;
  if (most_ != 0 && most_ < needed) {
    throw UsageError("--max-ram " + mebibytes(most_) + ": at least " + mebibytes(needed) +
                     " are needed here (" + mebibytes(at_start) + " before the first sweep, and " +
                     mebibytes(needed - at_start) + " to work in).");
  }
  spare_ = most_ != 0 ? most_ - without_graph - (makes_map ? most_ / kGraphShare : 0) : 0;
}

uint64_t MemoryLimit::submap_bytes() const {
  return most_ == 0 ? kSubmapBytes : std::min(kSubmapBytes, kLeastSubmapBytes + spare_);
}

MapMemory MemoryLimit::map_memory() const {
  return most_ == 0 ? MapMemory{}
                    : MapMemory{.submap_bytes = submap_bytes(), .graph_bytes = most_ / kGraphShare};
}

bool MemoryLimit::exceeded() const {
  if (most_ == 0 || resident_bytes() + most_ / kHeadroom <= most_) {
    return false;
  }
  release_free_memory();
  return resident_bytes() > most_;
}

std::string MemoryLimit::text() const {
  return "--max-ram " + mebibytes(most_) + ": " + mebibytes(resident_bytes()) + " are resident";
}

}  // namespace adit
