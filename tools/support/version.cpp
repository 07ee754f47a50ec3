// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/support/version.hpp"

namespace adit {

std::string_view version() {
  return ADIT_VERSION;
}

}  // namespace adit
