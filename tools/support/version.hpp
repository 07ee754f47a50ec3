// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace adit {

/// "major.minor.patch", as the build sets it.
std::string_view version();

}  // namespace adit
