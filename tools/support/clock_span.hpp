// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace adit {

/// When something was done, on the host's steady clock.
struct ClockSpan {
  std::chrono::steady_clock::time_point begin{};
  std::chrono::steady_clock::time_point end{};

  double ms() const { return std::chrono::duration<double, std::milli>(end - begin).count(); }
};

}  // namespace adit
