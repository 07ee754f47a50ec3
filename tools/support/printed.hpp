// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace adit {

/// A text by printf's rules, however long.
[[gnu::format(printf, 1, 2)]] std::string printed(const char* format, ...);

}  // namespace adit
