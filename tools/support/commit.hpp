// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace adit {

/// What `git describe` said of the sources when this program was built, "-dirty" where they were
/// changed; "unknown" where they were no checkout. commit.cmake writes the definition.
std::string_view commit();

}  // namespace adit
