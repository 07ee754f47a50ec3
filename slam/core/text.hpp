// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace adit {

/// Numbers in reasons that people read, the same in every locale: rounded to so many digits
/// ("0.0123", "1.2e+06"), or with so many decimals ("12.0").
std::string in_digits(double value, int digits = 3);
std::string with_decimals(double value, int decimals);

}  // namespace adit
