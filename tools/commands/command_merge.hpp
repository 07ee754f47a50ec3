// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit merge A B ... -o MERGED.adit`.
#pragma once

#include <functional>
#include <iosfwd>

#include "adit/tools/map_merge/merge_job.hpp"

namespace adit {

class Command;

/// Merges maps into a new one. Reports on `out`, progress and mistakes on `err`. Returns the exit
/// code: 0 merged, 1 failed or nothing was tied to anything, 2 usage, 129, 130 or 143 after a
/// signal (nothing is written).
int merge_command(const MergeCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_merge_command(Command app, std::function<void(int)> done);

}  // namespace adit
