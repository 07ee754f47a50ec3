// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace adit {

/// Text as it may stand in HTML or SVG, also within an attribute's quotes. Control characters
/// become blanks, and what is no UTF-8 is replaced.
std::string escape_markup(std::string_view text);

}  // namespace adit
