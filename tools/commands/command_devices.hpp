// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit devices`: what is there, whether it offers what the kernels need, and whether it computes
// correctly.
#pragma once

#include <functional>
#include <iosfwd>

namespace adit {

class Command;

struct DevicesCommandOptions {
  bool json = false;
  bool self_test = true;
};

/// Returns the exit code: 0 when at least one device can be used, else 1.
int devices_command(const DevicesCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr once the command line is read; `done`
/// gets the exit code.
void add_devices_command(Command app, std::function<void(int)> done);

}  // namespace adit
