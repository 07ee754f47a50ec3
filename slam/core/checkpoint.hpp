// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace adit {

/// Long work calls it between its parts, on the caller's thread, several times a second or more.
/// An exception that it throws ends the work and reaches the caller. It may be empty.
using Checkpoint = std::function<void()>;

/// Calls it where there is one.
inline void pass(const Checkpoint& checkpoint) {
  if (checkpoint) {
    checkpoint();
  }
}

}  // namespace adit
