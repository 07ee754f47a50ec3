// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "adit/tools/live/live_options.hpp"
#include "adit/tools/run/run_view.hpp"

namespace adit {

/// Maps the messages of ROS 2 topics that are published. Returns the exit code: that of run_job(),
/// or 1 where receiving ended early. Throws InputError where no sweep arrives.
int map_topics(const LiveOptions& options, RunView* view, std::ostream& out, std::ostream& err);

}  // namespace adit
