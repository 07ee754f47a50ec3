// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit generate FOLDER`.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>

#include "adit/tools/cli/command_description.hpp"

namespace adit {

class Command;

/// Writes the program's manual pages and completions into a folder, as /usr/share has them. Returns
/// the exit code: 0 done, 1 a file cannot be written.
int generate_command(const CommandDescription& program, const std::filesystem::path& folder,
                     std::ostream& out, std::ostream& err);

/// Adds the sub-command. `program` is asked for all commands once the command line is read; `done`
/// gets the exit code.
void add_generate_command(Command app, std::function<CommandDescription()> program,
                          std::function<void(int)> done);

}  // namespace adit
