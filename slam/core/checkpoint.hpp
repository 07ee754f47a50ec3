// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace adit {

/// Long work calls it between its parts, on the caller's thread, some times a second. It may throw:
/// that ends the work, and comes out of it. Empty: the work is done in one go.
using Checkpoint = std::function<void()>;

/// Calls it where there is one.
inline void pass(const Checkpoint& checkpoint) {
  if (checkpoint) {
    checkpoint();
  }
}

}  // namespace adit
