// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>

#include "adit/tools/live/live_options.hpp"
#include "adit/tools/run/run_view.hpp"

namespace adit {

/// Maps a recording at its own pace. Returns the exit code of run_job().
int map_paced(const LiveOptions& options, RunView* view, std::ostream& out, std::ostream& err);

}  // namespace adit
