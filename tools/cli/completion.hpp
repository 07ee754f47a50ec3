// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
//
// Scripts by which shells complete the program's commands, options and values.
#pragma once

#include <string>

#include "adit/tools/cli/command_description.hpp"

namespace adit {

std::string bash_completion(const CommandDescription& program);
std::string zsh_completion(const CommandDescription& program);
std::string fish_completion(const CommandDescription& program);

}  // namespace adit
