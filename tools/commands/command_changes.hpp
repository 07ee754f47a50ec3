// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit changes MAP` and `adit changes BEFORE AFTER`.
#pragma once

#include <functional>
#include <iosfwd>

#include "adit/tools/map_changes/changes_job.hpp"

namespace adit {

class Command;

/// Compares the sessions of a map, or two maps. Reports on `out`, progress and mistakes on `err`.
/// Returns the exit code: 0 compared, 1 failed, 2 usage, 129, 130 or 143 after a signal (nothing is
/// written).
int changes_command(const ChangesCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_changes_command(Command app, std::function<void(int)> done);

}  // namespace adit
