// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/stop_signal.hpp"

#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>

namespace adit {
namespace {

constexpr std::array kStops = {SIGINT, SIGTERM, SIGHUP};

// A signal handler reaches nothing but lock-free atomics; other threads read it, too.
std::atomic<int> received_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);

extern "C" void note_signal(int signal) {
  received_signal = signal;
  for (const int stop : kStops) {
    std::signal(stop, SIG_DFL);
  }
}

}  // namespace

StopSignal::StopSignal() {
  received_signal = 0;
  for (std::size_t i = 0; i < kStops.size(); ++i) {
    earlier_[i] = std::signal(kStops[i], note_signal);
    if (kStops[i] == SIGHUP && earlier_[i] == SIG_IGN) {
      std::signal(SIGHUP, SIG_IGN);
    }
  }
  earlier_.back() = std::signal(SIGPIPE, SIG_IGN);
}

StopSignal::~StopSignal() {
  for (std::size_t i = 0; i < kStops.size(); ++i) {
    std::signal(kStops[i], earlier_[i]);
  }
  std::signal(SIGPIPE, earlier_.back());
}

int StopSignal::received() {
  return received_signal;
}

}  // namespace adit
