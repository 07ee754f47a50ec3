// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/run/memory_limit.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "adit/slam/mapping/submap_cache.hpp"
#include "adit/tools/support/resident_memory.hpp"
#include "adit/tools/support/usage_error.hpp"

namespace adit {
namespace {

// What is free goes back to the system before the limit is reached, by this share of it: the next
// keyframe needs room for a moment.
constexpr uint64_t kHeadroom = 4;

std::string mebibytes(uint64_t bytes) {
  return fmt::format("{} MiB", (bytes + (uint64_t{1} << 20U) - 1) >> 20U);
}

}  // namespace

MemoryLimit::MemoryLimit(uint64_t most_bytes, uint64_t working_bytes) : most_(most_bytes) {
  const uint64_t at_start = resident_bytes();
  const uint64_t needed = at_start + working_bytes;
  if (most_ != 0 && most_ < needed) {
    throw UsageError("--max-ram " + mebibytes(most_) + ": at least " + mebibytes(needed) +
                     " are needed here (" + mebibytes(at_start) + " before the first sweep, and " +
                     mebibytes(working_bytes) + " to work in).");
  }
  spare_ = most_ != 0 ? most_ - needed : 0;
}

uint64_t MemoryLimit::submap_bytes() const {
  return most_ == 0 ? kSubmapBytes : std::min(kSubmapBytes, kLeastSubmapBytes + spare_);
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
