// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "adit/slam/core/config.hpp"
#include "adit/slam/submaps/map_memory.hpp"

namespace adit {

/// Of submaps that stay in memory, where there is room for no more.
inline constexpr uint64_t kLeastSubmapBytes = uint64_t{8} << 20U;

/// What a run needs besides what is there before its first sweep, bytes, at `points_a_sweep` points
/// in the largest sweeps (docs/theory/mapping.md).
uint64_t working_bytes(const MappingConfig& mapping, std::size_t points_a_sweep);

/// Holds a command to an amount of memory that is resident (--max-ram). On software devices that is
/// the device's memory, too.
class MemoryLimit {
 public:
  /// Made when what does not grow is there: program, device, recording. `most_bytes` 0: no limit.
  /// Throws UsageError where less than `working_bytes` would be left, of which kLeastSubmapBytes
  /// are; `makes_map`: besides the graph's share.
  MemoryLimit(uint64_t most_bytes, uint64_t working_bytes, bool makes_map = false);

  /// What submaps in memory may take of it.
  uint64_t submap_bytes() const;
  /// What a map that grows may take of it. The graph's share hangs on `most_bytes` alone, since
  /// what becomes of a graph that outgrows it must not hang on what else is resident.
  MapMemory map_memory() const;
  /// More is resident than may be, also after what is free was given back to the system.
  bool exceeded() const;
  /// "--max-ram 300 MiB: ... are resident", for people.
  std::string text() const;

 private:
  uint64_t most_;
  uint64_t spare_ = 0;  ///< beyond what the command works in
};

}  // namespace adit
