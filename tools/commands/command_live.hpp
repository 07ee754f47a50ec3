// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit live SOURCE... -o OUT`.
#pragma once

#include <functional>
#include <iosfwd>

#include "adit/tools/live/live_options.hpp"

namespace adit {

class Command;

/// Maps what arrives. Returns the exit code: 0 done or ended by a signal, 1 failed on the data or
/// the device, or nothing arrived, 2 usage.
int live_command(const LiveOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command; see add_run_command().
void add_live_command(Command app, std::function<void(int)> done);

}  // namespace adit
