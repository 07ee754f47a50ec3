// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Devices and fork(). Vulkan does not define what becomes of a device in a forked process: the
// driver's threads stay with the parent, its locks may be taken for ever, and its handles in the
// kernel are the parent's as well. So the child is refused all work on a device, instead of waiting
// for ever, and destroys nothing. A device of its own is refused, too, since drivers keep state for
// the whole process.
#pragma once

#include <memory>

namespace adit::engine {

/// True in a process that was forked from one that had opened a device.
bool is_forked_from_device();

/// Throws Error in such a process.
void require_device_process();

/// Notes that this process opens a device. Throws as require_device_process().
void note_opened_device();

/// For destructors: in such a process the object is left as it is.
template <class State>
void leave_to_parent(std::unique_ptr<State>& state) {
  if (is_forked_from_device()) {
    static_cast<void>(state.release());
  }
}

}  // namespace adit::engine
