// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace adit {

/// A whole HTML page that needs nothing else, light or dark as the reader prefers. `body` is HTML:
/// h1, h2, p, tables, drawings, and findings (div.finding, also .problem and .good).
std::string html_page(std::string_view title, std::string_view body);

/// A report for people with its line ends, as HTML.
std::string html_text(std::string_view text);

/// A drawing, for a desktop and for a telephone: the reader's screen shows one of them.
std::string html_drawing(const std::function<std::string(double width)>& draw);

}  // namespace adit
