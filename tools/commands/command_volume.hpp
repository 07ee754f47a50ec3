// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit volume BEFORE AFTER`, `adit volume MAP` and `adit volume MAP --above HEIGHT`.
#pragma once

#include <functional>
#include <iosfwd>

#include "adit/tools/export/volume_job.hpp"

namespace adit {

class Command;

/// Measures volumes between two maps, two sessions, or a map and a plane. Reports on `out`,
/// progress and mistakes on `err`. Returns the exit code: 0 measured, 1 failed, 2 usage, 129, 130
/// or 143 after a signal (nothing is written).
int volume_command(const VolumeCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_volume_command(Command app, std::function<void(int)> done);

}  // namespace adit
