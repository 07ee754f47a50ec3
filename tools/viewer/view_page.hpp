// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace adit {

/// The page that the build has made of tools/viewer/page/, HTML packed with gzip. Empty where the
/// machine that built this program had no npm.
std::string_view view_page();

}  // namespace adit
