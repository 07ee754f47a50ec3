// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace adit {

/// A text as one word of a shell's command: in quotes where it needs them.
std::string shell_word(const std::string& text);

}  // namespace adit
