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
std::atomic<int> hang_up_count = 0;
static_assert(std::atomic<int>::is_always_lock_free);

extern "C" void note_signal(int signal) {
  received_signal = signal;
  for (const int stop : kStops) {
    std::signal(stop, SIG_DFL);
  }
}

extern "C" void count_hang_up(int) {
  ++hang_up_count;
}

}  // namespace

StopSignal::StopSignal(bool hang_up_stops) {
  received_signal = 0;
  for (std::size_t i = 0; i < kStops.size(); ++i) {
    const bool counts = kStops[i] == SIGHUP && !hang_up_stops;
    earlier_[i] = std::signal(kStops[i], counts ? count_hang_up : note_signal);
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

int StopSignal::hang_ups() {
  return hang_up_count;
}

}  // namespace adit
