// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace adit {

/// What pages and drawings carry, so that they are known for ours later.
inline constexpr std::string_view kGenerator = "adit";

/// "major.minor.patch", as the build sets it.
std::string_view version();

/// What the program was compiled with, e.g. "GCC 12.2.0".
std::string_view compiler();

/// How it was compiled: "Release", "Debug" or another of CMake's build types.
std::string_view build_type();

}  // namespace adit
