// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <iosfwd>
#include <string>

namespace adit {

/// Runs a command and turns what it throws into a message on `err`, headed by the command's name,
/// and an exit code: 2 for UsageError, 1 for everything else.
int guarded(const std::string& command, std::ostream& err, const std::function<int()>& body);

}  // namespace adit
