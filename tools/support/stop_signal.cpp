// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/stop_signal.hpp"

#include <csignal>

namespace adit {
namespace {

// A signal handler reaches nothing but variables of this kind.
volatile std::sig_atomic_t received_signal = 0;

extern "C" void note_signal(int signal) {
  received_signal = signal;
  std::signal(signal, SIG_DFL);
}

}  // namespace

StopSignal::StopSignal() {
  received_signal = 0;
  earlier_interrupt_ = std::signal(SIGINT, note_signal);
  earlier_terminate_ = std::signal(SIGTERM, note_signal);
}

StopSignal::~StopSignal() {
  std::signal(SIGINT, earlier_interrupt_);
  std::signal(SIGTERM, earlier_terminate_);
}

int StopSignal::received() {
  return received_signal;
}

}  // namespace adit
