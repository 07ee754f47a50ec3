// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit devices`: what is there, whether it offers what the kernels need, and whether it computes
// correctly.
#pragma once

#include <functional>
#include <iosfwd>

namespace CLI {
class App;
}

namespace adit {

struct DevicesCommandOptions {
  bool json = false;
  bool self_test = true;
};

/// Returns the exit code: 0 when at least one device can be used, else 1.
int devices_command(const DevicesCommandOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command. It runs on std::cout and std::cerr at the end of CLI parsing; `done` gets
/// the exit code.
CLI::App* add_devices_command(CLI::App& app, std::function<void(int)> done);

}  // namespace adit
