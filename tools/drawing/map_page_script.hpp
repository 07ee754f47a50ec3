// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace adit {

/// tools/drawing/map_page.js, which the build embeds.
std::string_view map_page_script();

}  // namespace adit
