// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit split MAP --session N -o OUT.adit`.
#pragma once

#include <functional>
#include <iosfwd>

#include "adit/tools/map_merge/split_job.hpp"

namespace adit {

class Command;

/// Writes sessions of a map as a new map. Reports on `out`, mistakes on `err`. Returns the exit
/// code: 0 written, 1 failed, 2 usage.
int split_command(const SplitCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_split_command(Command app, std::function<void(int)> done);

}  // namespace adit
