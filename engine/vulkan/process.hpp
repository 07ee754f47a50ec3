// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

namespace adit::engine {

/// The process that a device was opened in. Vulkan says nothing of fork(): a driver's threads and
/// locks stay behind, and whatever the child asks of a device waits for ever. So it is refused, and
/// so is a device of the child's own, for which some drivers need what the parent has.
class OpeningProcess {
 public:
  /// This one. Throws Error where it was forked from one that has opened a device.
  OpeningProcess();

  bool is_this() const;
  /// Throws Error in a process that was forked since.
  void require() const;

 private:
  pid_t id_;
};

}  // namespace adit::engine
