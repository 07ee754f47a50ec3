// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/vulkan/process.hpp"

#include <pthread.h>

#include <atomic>

#include "adit/engine/error.hpp"

namespace adit::engine {
namespace {

std::atomic<bool> opened{false};
std::atomic<bool> forked{false};  // since it was opened

}  // namespace

bool is_forked_from_device() {
  return forked;
}

void require_device_process() {
  if (forked) {
    throw Error(
        "this process was forked from one that had opened a Vulkan device, and a device does not "
        "survive a fork. Fork before the first device is opened, or start the process anew: "
        "Python's multiprocessing.get_context(\"spawn\") does");
  }
}

void note_opened_device() {
  require_device_process();
  if (!opened.exchange(true)) {
    pthread_atfork(nullptr, nullptr, [] { forked = true; });
  }
}

}  // namespace adit::engine
