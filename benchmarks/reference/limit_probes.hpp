// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// What the kernels that measure a device's limits compute, in double precision.
#pragma once

#include <cstdint>
#include <vector>

#include "adit/shaders/shared/limit_probes.h"

namespace adit::reference {

/// Sum of the chains of the invocation with this index in its group.
inline double multiply_add(const gpu::LimitMultiplyAddPush& push, uint32_t local) {
  double sum = 0.0;
  for (uint32_t c = 0; c < gpu::kChains; ++c) {
    double x = c + 0.125 * local;
    for (uint64_t step = 0; step < uint64_t{push.rounds} * gpu::kChainSteps; ++step) {
      x = x * double{push.factor} + double{push.addend};
    }
    sum += x;
  }
  return sum;
}

/// MurmurHash3's finaliser.
inline uint32_t mix32(uint32_t h) {
  h = (h ^ (h >> 16U)) * 0x85ebca6bU;
  h = (h ^ (h >> 13U)) * 0xc2b2ae35U;
  return h ^ (h >> 16U);
}

/// Exclusive or of all words of the records that a thread reads, by their place in a uvec4.
inline gpu::uvec4 gather(const std::vector<gpu::uvec4>& table, uint32_t count, uint32_t threads,
                         uint32_t thread) {
  const auto mask = static_cast<uint32_t>(table.size() / gpu::kRecordQuads) - 1;
  gpu::uvec4 all{};
  for (uint32_t i = thread; i < count; i += threads) {
    for (uint32_t quad = 0; quad < gpu::kRecordQuads; ++quad) {
      const gpu::uvec4& read = table[gpu::kRecordQuads * (mix32(i) & mask) + quad];
      all = {all.x ^ read.x, all.y ^ read.y, all.z ^ read.z, all.w ^ read.w};
    }
  }
  return all;
}

}  // namespace adit::reference
