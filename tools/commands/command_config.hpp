// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit config`.
#pragma once

#include <functional>
#include <iosfwd>

#include "adit/tools/setup/config_file.hpp"

namespace adit {

class Command;

/// Prints the effective configuration as TOML. Returns the exit code: 0, 1 for a bad file, 2 for a
/// bad option.
int config_command(const ConfigSource& source, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_config_command(Command app, std::function<void(int)> done);

}  // namespace adit
