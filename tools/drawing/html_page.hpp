// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace adit {

/// A whole HTML page that needs nothing else, light or dark as the reader prefers. `body` is HTML:
/// h1, h2, p, tables, drawings, and findings (div.finding, also .problem and .good).
std::string html_page(std::string_view title, std::string_view body);

}  // namespace adit
