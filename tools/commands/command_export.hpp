// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit export MAP`: what a map holds, in formats of others.
#pragma once

#include <functional>
#include <iosfwd>

#include "adit/tools/export/export_options.hpp"

namespace adit {

class Command;

/// Returns the exit code: 0 done, 1 the map cannot be read or the file not written, 2 usage.
int export_command(const ExportCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_export_command(Command app, std::function<void(int)> done);

}  // namespace adit
