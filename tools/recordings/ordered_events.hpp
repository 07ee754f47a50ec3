// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "adit/tools/recordings/recording.hpp"

namespace adit {

/// The same events in the order of their own stamps. Recorders store messages as they arrive: a
/// sweep that began before an IMU sample is often stored after it.
///
/// An event is held back until one was read whose stamp is `window` later, so memory holds what
/// arrives within the window, and 256 MiB at most. What is even later comes as soon as it is read:
/// behind events with later stamps, never lost. Events of equal stamps keep their order. Where
/// the recording is damaged, all that was read before comes first, then the error.
std::unique_ptr<EventStream> order_by_stamp(std::unique_ptr<EventStream> events,
                                            Nanoseconds window = std::chrono::milliseconds(500));

}  // namespace adit
