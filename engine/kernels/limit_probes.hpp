// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "adit/engine/buffer.hpp"
#include "adit/engine/kernel.hpp"
#include "adit/engine/kernels/launch.hpp"
#include "adit/engine/recorder.hpp"
#include "adit/shaders/shared/limit_probes.h"

namespace adit::engine {

/// Kernels that do one thing as fast as the device can, to compare others with. They read as the
/// others do: through texels where these are faster.
class LimitProbes {
 public:
  explicit LimitProbes(Context& context);

  /// Threads of every probe, and results that the last two write.
  uint32_t threads() const { return shape_.threads(); }

  /// Copies whole uvec4.
  void record_copy(Recorder& recorder, Slice from, Slice to) const;

  /// `results` takes threads() floats; of thread t the sum of kChains recurrences x <- factor x +
  /// addend of rounds * kChainSteps steps, the c-th from c + (t mod local size) / 8.
  void record_multiply_add(Recorder& recorder, const gpu::LimitMultiplyAddPush& push,
                           Slice results) const;
  uint32_t local_size() const { return shape_.local_size; }
  /// Operations of one record_multiply_add().
  double flop(uint32_t rounds) const {
    return 2.0 * rounds * gpu::kChainSteps * gpu::kChains * threads();
  }

  /// Reads `count` records of 64 bytes; the i-th is mix32(i) modulo those of the table, a power of
  /// two. `results` takes threads() uvec4; of thread t the exclusive or of the records of all i = t
  /// modulo threads().
  void record_gather(Recorder& recorder, uint32_t count, Slice table, Slice results) const;

  /// Adds 1 `count` times with integer atomics; the i-th time to word mix32(i) modulo those of the
  /// table, a power of two.
  void record_atomics(Recorder& recorder, uint32_t count, Slice table) const;

 private:
  LaunchShape shape_;
  bool texels_;
  Kernel copy_;
  Kernel multiply_add_;
  Kernel gather_;
  Kernel atomic_;
};

}  // namespace adit::engine
