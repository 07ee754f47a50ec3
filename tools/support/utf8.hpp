// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace adit {

/// The names of files may hold any bytes, and pages, TOML and JSON may not: what is no UTF-8
/// becomes U+FFFD.
std::string as_utf8(std::string_view text);

}  // namespace adit
