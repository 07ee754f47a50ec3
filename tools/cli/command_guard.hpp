// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <iosfwd>
#include <string>

namespace adit {

/// The exit code of a command that reported on `out`, or 1 where `out` could not take it whole (a
/// full disk, a closed pipe); that is said on `err`.
int reported(const std::string& command, std::ostream& out, std::ostream& err, int code);

/// Runs a command and turns what it throws into a message on `err`, headed by the command's name,
/// and an exit code: 2 for UsageError, 1 for everything else. Ends with
/// reported().
int guarded(const std::string& command, std::ostream& out, std::ostream& err,
            const std::function<int()>& body);

}  // namespace adit
