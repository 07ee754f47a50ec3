// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/engine/vulkan/process.hpp"

#include <unistd.h>

#include <atomic>

#include "adit/engine/error.hpp"

namespace adit::engine {
namespace {

[[noreturn]] void refuse() {
  throw Error(
      "this process was forked from one that had opened a Vulkan device, and a device does not "
      "survive a fork. Fork before the first device is opened, or start the process anew: Python's "
      "multiprocessing.get_context(\"spawn\") does");
}

}  // namespace

OpeningProcess::OpeningProcess() : id_(getpid()) {
  static std::atomic<pid_t> first{0};  // of this process, or of the one that it was forked from
  pid_t opened = 0;
  if (!first.compare_exchange_strong(opened, id_) && opened != id_) {
    refuse();
  }
}

bool OpeningProcess::is_this() const {
  return getpid() == id_;
}

void OpeningProcess::require() const {
  if (!is_this()) {
    refuse();
  }
}

}  // namespace adit::engine
