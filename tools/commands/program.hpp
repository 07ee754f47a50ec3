// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>

#include "adit/tools/cli/command_line.hpp"

namespace adit {

/// Adds a sub-command, which hands its exit code to the function given.
using AddCommand = std::function<void(Command, std::function<void(int)>)>;

/// The whole program: parses the command line, runs the command on the standard streams, returns
/// the exit code (0 done, 1 failed on the data or the device, 2 usage). Throws nothing. `more` are
/// sub-commands of layers above this.
int program(int argc, const char* const* argv, std::span<const AddCommand> more = {});

}  // namespace adit
