// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

namespace adit {

/// Without blanks, a line end of Windows and '#' around it.
std::string_view trimmed_cell(std::string_view text);

/// What stands between the commas of a line, trimmed.
std::vector<std::string_view> cells_of(std::string_view line);

}  // namespace adit
