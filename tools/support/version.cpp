// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/version.hpp"

#include "adit/version.hpp"

namespace adit {

std::string_view version() {
  return kVersion;
}

std::string_view compiler() {
#ifdef __clang__
  return "Clang " __clang_version__;
#else
  return "GCC " __VERSION__;
#endif
}

std::string_view build_type() {
  return ADIT_BUILD_TYPE;
}

}  // namespace adit
