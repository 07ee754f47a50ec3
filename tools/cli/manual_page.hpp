// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adit/tools/cli/command_description.hpp"

namespace adit {

/// A page for man(1), in section 1.
struct ManualPage {
  std::string name{};  ///< "adit-bench-slam"
  std::string text{};  ///< roff, with the macros of man(7)
};

/// A page for a program and one for each of its commands. A footer's paragraphs "Examples:",
/// "Exit codes:" and "Environment:" become sections of their own, the others the description.
std::vector<ManualPage> manual_pages(const CommandDescription& program);

}  // namespace adit
