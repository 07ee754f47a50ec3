// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adit/slam/core/types.hpp"

namespace adit {

/// From the first to the last.
struct TimeSpan {
  Nanoseconds begin{0};
  Nanoseconds end{0};
};

}  // namespace adit
