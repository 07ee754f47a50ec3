// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit run RECORDING -o OUT`.
#pragma once

#include <functional>
#include <iosfwd>

#include "adit/tools/run/run_options.hpp"

namespace adit {

class Command;

/// Maps a recording. Returns the exit code: 0 done, 1 failed on the data or the device, 2 usage,
/// 128 + signal when stopped by one. What was computed before a failure stays in the output folder.
int run_command(const RunCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_run_command(Command app, std::function<void(int)> done);

}  // namespace adit
