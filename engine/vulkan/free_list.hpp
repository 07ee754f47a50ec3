// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace adit::engine {

/// The free ranges of a block of memory: first fit, neighbours joined. Positions and sizes in
/// bytes.
class FreeList {
 public:
  explicit FreeList(uint64_t bytes);

  /// The position of `bytes` that are taken now; empty where no free range is long enough. All
  /// sizes are multiples of the caller's alignment, so that positions are as well.
  std::optional<uint64_t> take(uint64_t bytes);
  /// Gives back what take() gave.
  void give(uint64_t position, uint64_t bytes);

  bool unused() const;  ///< nothing is taken
  uint64_t size() const { return bytes_; }

 private:
  struct Range {
    uint64_t position;
    uint64_t bytes;
  };
  uint64_t bytes_;
  std::vector<Range> ranges_;  // by position; no two touch
};

}  // namespace adit::engine
