// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// `adit record SOURCE... -o FILE`.
#pragma once

#include <functional>
#include <iosfwd>

#include "adit/tools/live/record_job.hpp"

namespace adit {

class Command;

/// Records what arrives. Returns the exit code: 0 done or ended by a signal, 1 nothing arrived or
/// recording failed, 2 usage.
int record_command(const RecordOptions& options, std::ostream& out, std::ostream& err);

/// Adds the sub-command; see add_run_command().
void add_record_command(Command app, std::function<void(int)> done);

}  // namespace adit
