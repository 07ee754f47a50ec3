// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

namespace adit {

/// What a report of a problem begins with, in lines: the build, the command as a shell takes it,
/// and what the environment says of devices.
std::vector<std::string> describe_invocation(std::span<const char* const> words);

}  // namespace adit
