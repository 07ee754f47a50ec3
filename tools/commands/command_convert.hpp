// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit convert IN OUT`.
#pragma once

#include <functional>
#include <iosfwd>

#include "adit/tools/export/convert_recording.hpp"

namespace adit {

class Command;

/// Converts, tells on `out` what was written and on `err` what was wrong. Returns the exit code: 0
/// done, 1 failed or the input is damaged (what could be read is written), 2 usage.
int convert_command(const ConvertOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_convert_command(Command app, std::function<void(int)> done);

}  // namespace adit
