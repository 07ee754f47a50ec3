// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Python's global lock (GIL), and its signals (Ctrl-C).
#pragma once

#include <chrono>
#include <utility>

#include <pybind11/pybind11.h>

#include "adit/slam/core/checkpoint.hpp"

namespace adit::python {

/// Runs the handlers of signals that have come, and throws what they raise: KeyboardInterrupt.
/// Nothing in threads but the main one, where Python runs no handlers. Whoever calls holds the GIL.
inline void check_signals() {
  if (PyErr_CheckSignals() != 0) {
    throw pybind11::error_already_set();
  }
}

/// Calls it while other Python threads run. It must not return a Python object. Take adit's own
/// locks only in here: a thread that waits for one with the GIL stops all others. Pending signals
/// are handled first, since C code that iterates, such as list(), never handles them.
template <class Call>
auto without_gil(Call&& call) {
  check_signals();
  const pybind11::gil_scoped_release released;
  return std::forward<Call>(call)();
}

/// For long work without the GIL: check_signals(), twenty times a second at most, since another
/// thread may keep the GIL for some milliseconds.
inline Checkpoint signal_checks() {
  using Clock = std::chrono::steady_clock;
  return [last = Clock::now()]() mutable {
    if (Clock::now() - last < std::chrono::milliseconds(50)) {
      return;
    }
    const pybind11::gil_scoped_acquire acquired;
    check_signals();
    last = Clock::now();
  };
}

}  // namespace adit::python
