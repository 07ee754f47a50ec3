// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <thread>

namespace adit {

/// Waits until the file of a recorder (PacketRecorder, MessageRecorder) is longer than `at` bytes.
/// False where the recorder has finished before. It looks every 2 ms, which is little beside the
/// period of a sweep, and leaves the recorder without a lock.
template <class Recorder>
bool wait_for_growth(const Recorder& recorder, uint64_t at) {
  while (at >= recorder.committed()) {
    // Finished first: what was written before that is seen.
    if (recorder.finished() && at >= recorder.committed()) {
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

}  // namespace adit
