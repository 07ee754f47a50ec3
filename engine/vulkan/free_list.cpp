// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/vulkan/free_list.hpp"

#include <algorithm>

namespace adit::engine {

FreeList::FreeList(uint64_t bytes) : bytes_(bytes), ranges_{{0, bytes}} {}

std::optional<uint64_t> FreeList::take(uint64_t bytes) {
  const auto range =
      std::ranges::find_if(ranges_, [&](const Range& r) { return r.bytes >= bytes; });
  if (range == ranges_.end()) {
    return std::nullopt;
  }
  const uint64_t position = range->position;
  range->position += bytes;
  range->bytes -= bytes;
  if (range->bytes == 0) {
    ranges_.erase(range);
  }
  return position;
}

void FreeList::give(uint64_t position, uint64_t bytes) {
  auto range = ranges_.insert(std::ranges::lower_bound(ranges_, position, {}, &Range::position),
                              {position, bytes});
  if (const auto next = range + 1;
      next != ranges_.end() && range->position + range->bytes == next->position) {
    range->bytes += next->bytes;
    ranges_.erase(next);
  }
  if (range != ranges_.begin()) {
    const auto previous = range - 1;
    if (previous->position + previous->bytes == range->position) {
      previous->bytes += range->bytes;
      ranges_.erase(range);
    }
  }
}

bool FreeList::unused() const {
  return ranges_.size() == 1 && ranges_.front().bytes == bytes_;
}

}  // namespace adit::engine
