// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "adit/engine/context.hpp"
#include "adit/slam/core/config.hpp"
#include "adit/tools/recordings/recording.hpp"
#include "adit/tools/run/run_mapping.hpp"

namespace adit {

/// Places the first two sweeps that can be read, for nothing. What ends a run there ends it here
/// while the files of an earlier one are still there. Throws InputError where there is no such
/// sweep, and what the device throws.
void rehearse(const Recording& recording, std::size_t topic, const SweepRange& range,
              const Config& config, engine::Context& context);

}  // namespace adit
